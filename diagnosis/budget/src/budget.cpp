// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/budget.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <rths/budget/shapley.hpp>
#include <rths/budget/transfer_system.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/core/side_by_side.hpp>

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

/// Energies of the difference to the test, by set of identified parts. Each loop runs once, before
/// it is asked for.
class Loops {
 public:
  Loops(const HybridTest& test, const Response& measured)
      : test_{test},
        measured_{measured},
        is_late_{!test.host.order.machine_before.empty() || !test.host.arrivals.empty()},
        energies_(std::size_t{1} << kParts) {}

  /// @throws Error if a loop diverges
  void run(std::vector<Parts> sets) {
    std::erase_if(sets, [&](Parts parts) { return energies_[parts].has_value(); });
    std::vector<Response> responses(sets.size());
    side_by_side(sets.size(), [&](std::size_t i) { responses[i] = closed_loop(test_, sets[i]); });
    for (std::size_t i = 0; i < sets.size(); ++i) {
      energies_[sets[i]] = energies_of(responses[i], sets[i]);
      if (sets[i] == kNone)
        simulated_ = std::move(responses[i]);
      else if (sets[i] == all())
        improved_ = std::move(responses[i]);
    }
    runs_ += static_cast<int>(sets.size());
  }
  [[nodiscard]] double energy(Parts parts, std::size_t axis) const {
    return (*energies_[parts])[axis];
  }
  [[nodiscard]] const Response& simulated() const { return simulated_; }
  [[nodiscard]] const Response& improved() const { return improved_; }
  /// The last part, the host, is as simulated if it was never late.
  [[nodiscard]] std::size_t parts() const { return is_late_ ? kParts : kParts - 1; }
  [[nodiscard]] Parts all() const { return (Parts{1} << parts()) - 1; }
  /// None, each part alone, all but each, all.
  [[nodiscard]] std::vector<Parts> ends() const {
    std::vector<Parts> sets{kNone, all()};
    for (std::size_t i = 0; i < parts(); ++i) {
      sets.push_back(Parts{1} << i);
      sets.push_back(all() & ~(Parts{1} << i));
    }
    return sets;
  }
  [[nodiscard]] int runs() const { return runs_; }

 private:
  [[nodiscard]] std::array<double, 2> energies_of(const Response& response, Parts parts) const {
    std::array<double, 2> energies{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      energies[axis] = energy_between(measured_[axis], response[axis]);
      if (!std::isfinite(energies[axis]))
        throw Error{
            fmt::format("the closed loop diverges with {} as identified", parts_text(parts))};
    }
    return energies;
  }

  const HybridTest& test_;
  const Response& measured_;
  bool is_late_;
  std::vector<std::optional<std::array<double, 2>>> energies_;
  Response simulated_, improved_;
  int runs_ = 0;
};

/// From 2 loops for each part and 2 more, if these tell the shares of all axes; else from all.
/// @returns the largest error of the sum of an axis's shares before they were made to add up [-]
double share_out(Loops& loops, std::vector<AxisBudget>& axes) {
  constexpr double kMostGap = 0.01;  // [-]; texts give shares in per cent
  const auto removed = [&](const AxisBudget& budget) {
    const std::size_t axis = index_of(budget.axis);
    return [&loops, axis, all = loops.energy(kNone, axis)](unsigned parts) {
      return 1 - loops.energy(parts, axis) / all;
    };
  };
  const auto keep = [](const std::vector<double>& shares, AxisBudget& budget) {
    std::copy(shares.begin(), shares.end(), budget.share.begin());
  };
  double largest = 0;
  for (auto& axis : axes) {
    if (!(axis.before > 0)) continue;
    const auto found = shapley_from_ends(loops.parts(), removed(axis));
    keep(found.shares, axis);
    largest = std::max(largest, std::abs(found.gap));
  }
  if (largest <= kMostGap) return largest;
  std::vector<Parts> every;
  for (Parts parts = kNone; parts <= loops.all(); ++parts) every.push_back(parts);
  loops.run(std::move(every));
  for (auto& axis : axes)
    if (axis.before > 0) keep(shapley(loops.parts(), removed(axis)), axis);
  return 0;
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
  Loops loops{test, measured};
  loops.run(loops.ends());
  const Response again = replayed(test, force);
  double apart = 0, all = 0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!test.tested[axis]) continue;
    AxisBudget one;
    one.axis = kHorizontal[axis];
    one.transfer = systems[axis];
    one.measured = measured[axis];
    one.simulated = loops.simulated()[axis];
    one.improved = loops.improved()[axis];
    one.noise =
        std::sqrt(energy(test.noise[axis].displacement) / energy(records[axis].displacement));
    const double size = energy(measured[axis]);
    one.before = std::sqrt(loops.energy(kNone, axis) / size);
    one.after = std::sqrt(loops.energy(loops.all(), axis) / size);
    // No part causes a difference that is none.
    one.remainder = one.before > 0 ? std::pow(one.after / one.before, 2) : 1;
    budget.axes.push_back(std::move(one));
    apart += energy_between(measured[axis], again[axis]);
    all += size;
  }
  budget.replay = std::sqrt(apart / all);
  budget.share_error = share_out(loops, budget.axes);
  budget.loops = loops.runs();
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
