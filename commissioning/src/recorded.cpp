// SPDX-License-Identifier: Apache-2.0
#include <rths/commissioning/recorded.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::commissioning {
namespace {

using recording::AxisRoles;

struct NamedRole {
  const char* name;
  std::string AxisRoles::*member;
};
constexpr NamedRole kRoles[] = {{"target", &AxisRoles::target},
                                {"command", &AxisRoles::command},
                                {"displacement", &AxisRoles::displacement},
                                {"force", &AxisRoles::force},
                                {"reference", &AxisRoles::reference},
                                {"reference_echo", &AxisRoles::reference_echo},
                                {"machine_displacement", &AxisRoles::machine_displacement},
                                {"machine_acceleration", &AxisRoles::machine_acceleration},
                                {"machine_force", &AxisRoles::machine_force},
                                {"returned_displacement", &AxisRoles::returned_displacement},
                                {"returned_force", &AxisRoles::returned_force}};

std::vector<double> at_equal_intervals(const std::vector<double>& time,
                                       const std::vector<double>& values, double interval,
                                       std::size_t count) {
  std::vector<double> t, x;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (std::isfinite(values[i])) {
      t.push_back(time[i]);
      x.push_back(values[i]);
    }
  std::vector<double> result(count, 0.0);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double now = time.front() + static_cast<double>(i) * interval;
    while (next < t.size() && t[next] < now) ++next;
    if (next == 0 || next == t.size()) {
      result[i] = next == 0 ? x.front() : x.back();
      continue;
    }
    const double part = (now - t[next - 1]) / (t[next] - t[next - 1]);
    result[i] = (1 - part) * x[next - 1] + part * x[next];
  }
  return result;
}

}  // namespace

Recorded recorded(const recording::Reader& run, const std::vector<std::string>& names) {
  const auto& time = run.time();
  if (time.size() < 2)
    throw Error{fmt::format("the recording has {} rows, expected at least two", time.size())};
  Recorded result;
  result.interval = maths::median(maths::steps_of(time));
  result.begin = time.front();
  if (!(result.interval > 0)) throw Error{"the times of the recording do not rise"};
  const auto count =
      static_cast<std::size_t>(std::floor((time.back() - time.front()) / result.interval + 0.5)) +
      1;
  for (const auto& name : names) {
    auto values = run.signal(name);
    values.resize(time.size(), std::nan(""));  // shorter after a crash of the writer
    if (std::none_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); }))
      throw Error{fmt::format("'{}' has no finite value, expected at least one", name)};
    result.values.push_back(at_equal_intervals(time, values, result.interval, count));
  }
  return result;
}

bool is_axis_role(const std::string& name) {
  return std::any_of(std::begin(kRoles), std::end(kRoles),
                     [&](const auto& role) { return role.name == name; });
}

const std::string& signal_of(const AxisRoles& axis, const std::string& role) {
  for (const auto& known : kRoles)
    if (known.name == role) return axis.*known.member;
  throw Error{fmt::format("there is no role '{}' of an axis", role)};
}

}  // namespace rths::commissioning
