// SPDX-License-Identifier: Apache-2.0
#include "companions.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/recording/step_at.hpp>

#include "evidence.hpp"

namespace rths::report {
namespace {

// Model time of each target of the solver.
std::vector<double> times_of_targets(const Reader& run, const Roles& roles,
                                     const std::vector<double>& targets, double step) {
  auto time = run.has(roles.time) ? at_each_count(targets, run.signal(roles.time))
                                  : std::vector<double>(targets.size());
  if (!time.empty() && time.back() == 0)  // a solver that does not write it
    for (std::size_t i = 0; i < time.size(); ++i) time[i] = static_cast<double>(i + 1) * step;
  return time;
}

// Value of a series at a time; none before its first row and after its last. The first row is one
// interval after the start. Rows of the same interval are at the same times, apart from rounding.
std::optional<double> value_at(double time, const std::vector<double>& values, double interval,
                               bool has_same_interval) {
  constexpr double kRounding = 1e-3;  // of recorded times, over an interval
  const double place = time / interval - 1;
  const auto nearest =
      has_same_interval ? recording::step_at(time, interval) : std::lround(time / interval) - 1;
  const auto rows = static_cast<long>(values.size());
  const auto value = [&](long row) { return values[static_cast<std::size_t>(row)]; };
  if (has_same_interval || std::abs(place - static_cast<double>(nearest)) < kRounding)
    return nearest >= 0 && nearest < rows ? std::optional{value(nearest)} : std::nullopt;
  const double before = std::floor(place);
  const auto row = static_cast<long>(before);
  if (row < 0 || row + 1 >= rows) return std::nullopt;
  return std::lerp(value(row), value(row + 1), place - before);
}

// A displacement at times of a test, one per target.
struct TestResponse {
  const std::vector<double>& time;
  const std::vector<double>& displacement;
  double interval;  ///< of its targets [s]
};

// Difference between a displacement of the test and that of another result at the same times.
double difference(const TestResponse& test, const NumericalAxis& other, double interval) {
  const bool has_same_interval = std::abs(test.interval - interval) <= 1e-9 * interval;
  double apart = 0, all = 0;
  for (std::size_t i = 0; i < std::min(test.time.size(), test.displacement.size()); ++i) {
    const auto value = value_at(test.time[i], other.displacement, interval, has_same_interval);
    if (!value) continue;
    const double displacement = test.displacement[i], error = *value - displacement;
    apart += error * error;
    all += displacement * displacement;
  }
  return all > 0 ? std::sqrt(apart / all) : 0;
}

// The other test's response along an axis of this one.
NumericalAxis response_of(const AxisAnalysis& other, double other_step, const AxisAnalysis& axis,
                          double step) {
  NumericalAxis result;
  result.name = axis.name;
  result.displacement = other.step_displacement;
  result.force = other.step_force;
  result.peak_displacement = other.peak_displacement;
  result.peak_shear = other.peak_shear;
  std::vector<double> time;
  for (std::size_t i = 0; i < axis.step_displacement.size(); ++i)
    time.push_back(static_cast<double>(i + 1) * step);
  result.difference = difference({time, axis.step_displacement, step}, result, other_step);
  return result;
}

// The other test's spectra of the floors that both have.
void add_spectra_of(Analysis& analysis, const Analysis& other) {
  for (auto& floor : analysis.spectra.floors)
    for (const auto& same : other.spectra.floors)
      if (same.floor == floor.floor) floor.spectra.push_back({kBeside, same.spectra[0].values});
}

}  // namespace

std::vector<NumericalAxis> numerical_axes(const Reader& run, const Roles& roles, double step,
                                          const Reader& numerical) {
  const double interval = numerical.time()[1] - numerical.time()[0];
  // The solver's own count is exact where its target and the controller's are not of one row.
  const std::string counter = "monitor." + roles.solver + ".step";
  const auto steps = run.has(counter) ? run.signal(counter) : targets_of(run, roles);
  const auto time = times_of_targets(run, roles, steps, step);
  std::vector<NumericalAxis> axes;
  for (const auto& names : roles.axes) {
    if (!run.has(names.target)) continue;
    NumericalAxis result;
    result.name = names.axis;
    result.displacement = numerical.signal("result.displ." + names.axis);
    result.force = numerical.signal("result.force." + names.axis);
    result.peak_displacement = largest_magnitude(result.displacement);
    result.peak_shear = largest_magnitude(result.force);
    const auto displacement = at_each_count(steps, run.signal(names.target));
    result.difference = difference({time, displacement, step}, result, interval);
    axes.push_back(std::move(result));
  }
  return axes;
}

std::map<std::string, double> response_differences(const Reader& run, const Reader& numerical) {
  std::map<std::string, double> differences;
  const auto experiment = recording::experiment_in(run);
  if (!experiment) return differences;
  const double step = experiment->number("integration_step_s", 0.01);
  for (const auto& axis : numerical_axes(run, recording::roles_of(run), step, numerical))
    differences[axis.name] = axis.difference;
  return differences;
}

CompanionAnalysis analyse_companions(const Reader& run, const Roles& roles, double step,
                                     const std::vector<AxisAnalysis>& axes,
                                     const CompanionRecordings& companions) {
  if (companions.numerical == nullptr) return {};
  const auto of_analysed_axes = [&](const Reader& result) {
    auto all = numerical_axes(run, roles, step, result);
    std::erase_if(all, [&](const NumericalAxis& axis) {
      return std::ranges::none_of(axes, [&](const auto& one) { return one.name == axis.name; });
    });
    return all;
  };
  CompanionAnalysis found;
  found.interval = companions.numerical->time()[1] - companions.numerical->time()[0];
  found.numerical = of_analysed_axes(*companions.numerical);
  if (companions.improved != nullptr) found.improved = of_analysed_axes(*companions.improved);
  return found;
}

void add_beside(Analysis& analysis, const std::filesystem::path& folder) {
  const Analysis other = analyse(folder);
  const RunDescription& test = other.test;
  Beside beside{test.name, folder.string(), test.rate, test.ending, test.integration_step, {}};
  for (const auto& axis : analysis.axes) {
    const auto same = std::ranges::find_if(
        other.axes, [&](const AxisAnalysis& one) { return one.name == axis.name; });
    if (same == other.axes.end())
      throw Error{
          fmt::format("{}: has no axis {}, which this test has", folder.string(), axis.name)};
    beside.axes.push_back(
        response_of(*same, test.integration_step, axis, analysis.test.integration_step));
  }
  add_spectra_of(analysis, other);
  analysis.beside = std::move(beside);
}

}  // namespace rths::report
