// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/budget.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/budget/shapley.hpp>
#include <rths/budget/transfer_system.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>

namespace rths::budget {
namespace {

constexpr double kWorthNaming = 0.02;  // share [-]
constexpr const char* kPartNames[kParts] = {"tracking", "force",     "specimen",
                                            "machine",  "numerical", "host"};
constexpr const char* kPartTexts[kParts] = {"tracking of the machine",
                                            "measurement of the force",
                                            "the specimen",
                                            "friction and inertia of the machine",
                                            "the numerical side",
                                            "lateness of the host"};

double energy(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return sum;
}

double energy_between(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

std::string parts_text(Parts parts) {
  std::string text;
  for (std::size_t i = 0; i < kParts; ++i)
    if ((parts >> i & 1U) != 0)
      text += fmt::format("{}{}", text.empty() ? "" : ", ", kPartNames[i]);
  return text.empty() ? "nothing" : text;
}

/// Energies of the difference to the test, by set of identified parts and axis.
using Energies = std::vector<std::array<double, 2>>;

Energies energies_of(const HybridTest& test, const Response& measured, Response& simulated,
                     Response& improved) {
  Energies energies(std::size_t{1} << kParts);
  const bool is_late = !test.host.order.machine_before.empty() || !test.host.arrivals.empty();
  for (Parts parts = kNone; parts <= kAll; ++parts) {
    if (!is_late && has(parts, Part::Host)) {
      energies[parts] = energies[parts & ~only(Part::Host)];
      continue;
    }
    Response response = closed_loop(test, parts);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      energies[parts][axis] = energy_between(measured[axis], response[axis]);
      if (!std::isfinite(energies[parts][axis]))
        throw Error{
            fmt::format("the closed loop diverges with {} as identified", parts_text(parts))};
    }
    if (parts == kNone) simulated = response;
    if ((parts | only(Part::Host)) == kAll) improved = std::move(response);
  }
  return energies;
}

void share_out(const Energies& energies, std::size_t axis, AxisBudget& budget) {
  const double all = energies[kNone][axis];
  if (!(all > 0)) {  // no part causes a difference that is none
    budget.remainder = 1;
    return;
  }
  const auto shares =
      shapley(kParts, [&](unsigned parts) { return 1 - energies[parts][axis] / all; });
  std::copy(shares.begin(), shares.end(), budget.share.begin());
  budget.remainder = energies[kAll][axis] / all;
}

std::string percent(double value) { return fmt::format("{:.3g}", 100 * value); }

/// The values of all axes: "37 and 17".
template <class Value>
std::string each(const MismatchBudget& budget, Value value) {
  std::string text;
  for (const auto& axis : budget.axes)
    text += fmt::format("{}{}", text.empty() ? "" : " and ", value(axis));
  return text;
}

double total(const MismatchBudget& budget, std::size_t part) {
  double sum = 0;
  for (const auto& axis : budget.axes) sum += axis.share[part];
  return sum;
}

}  // namespace

const char* name_of(Part part) { return kPartNames[static_cast<unsigned>(part)]; }

MismatchBudget mismatch_budget(HybridTest test, const Response& measured,
                               const std::array<sim::TransferRecord, 2>& records,
                               const std::array<std::vector<double>, 2>& force) {
  std::array<sim::AxisTransfer, 2> systems;
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (test.tested[axis]) {
      systems[axis] = identify_transfer(records[axis]);
      auto& hydraulics = test.machine_identified.axes[axis];
      hydraulics = servo_axis(systems[axis], hydraulics);
    }
  test.noise = sensor_noise(test, records);
  MismatchBudget budget;
  budget.integration_step = test.integration_step;
  Response simulated, improved;
  const Energies energies = energies_of(test, measured, simulated, improved);
  const Response again = replayed(test, force);
  double apart = 0, all = 0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!test.tested[axis]) continue;
    AxisBudget one;
    one.axis = kHorizontal[axis];
    one.transfer = systems[axis];
    one.measured = measured[axis];
    one.simulated = simulated[axis];
    one.improved = improved[axis];
    one.noise =
        std::sqrt(energy(test.noise[axis].displacement) / energy(records[axis].displacement));
    const double size = energy(measured[axis]);
    one.before = std::sqrt(energies[kNone][axis] / size);
    one.after = std::sqrt(energies[kAll][axis] / size);
    share_out(energies, axis, one);
    budget.axes.push_back(std::move(one));
    apart += energy_between(measured[axis], again[axis]);
    all += size;
  }
  budget.replay = std::sqrt(apart / all);
  return budget;
}

bool is_tracking_identified(const MismatchBudget& budget) {
  constexpr double kMostError = 0.1;
  return !budget.is_empty() &&
         std::all_of(budget.axes.begin(), budget.axes.end(), [](const AxisBudget& axis) {
           const double unseen = std::isfinite(axis.held_out)
                                     ? std::max(axis.held_out, axis.transfer.error)
                                     : axis.transfer.error;
           return unseen <= kMostError * axis.transfer.error_without;
         });
}

std::string sentence_of(const MismatchBudget& budget) {
  if (budget.is_empty()) return "";
  std::array<std::size_t, kParts> order{};
  for (std::size_t i = 0; i < kParts; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return total(budget, a) > total(budget, b);
  });
  const auto whole = [](double value) { return fmt::format("{:.0f}", 100 * value); };
  std::string shares;
  for (const std::size_t part : order) {
    const bool matters = std::any_of(budget.axes.begin(), budget.axes.end(), [&](const auto& axis) {
      return std::abs(axis.share[part]) >= kWorthNaming;
    });
    if (!matters) continue;
    shares += fmt::format("{} {} %, ", kPartTexts[part],
                          each(budget, [&](const auto& axis) { return whole(axis.share[part]); }));
  }
  return fmt::format(
      "The response of the test differs from that of the simulation by {} % rms ({}): {}remainder "
      "{} % of it. With all parts as identified the difference is {} %.",
      each(budget, [](const auto& axis) { return percent(axis.before); }),
      each(budget, [](const auto& axis) { return name_of(axis.axis); }), shares,
      each(budget, [](const auto& axis) { return fmt::format("{:.1f}", 100 * axis.remainder); }),
      each(budget, [](const auto& axis) { return percent(axis.after); }));
}

}  // namespace rths::budget
