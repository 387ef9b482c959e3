// SPDX-License-Identifier: Apache-2.0
#include "recorded_host.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/launch/run.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/recording/roles.hpp>

namespace rths::session {
namespace {

using experiment::NodePlan;
using recording::NodeTicks;
using recording::Reader;

constexpr double kMostSteps = 5;  // of integration, in a gap

/// Of the steps of a node [s].
struct Schedule {
  double period = 0.001, phase = 0;
  bool makes_due = false;  ///< missed steps, with the inputs of their own time
};

Schedule schedule_of(const Experiment& experiment, const std::string& node) {
  const NodePlan* plan = experiment.node(node);
  if (plan == nullptr) return {};
  return {to_seconds(plan->schedule.period), to_seconds(plan->schedule.phase),
          plan->schedule.missed == MissedSteps::MakeDue};
}

void check_node(const Experiment& experiment, const Reader& run, const std::string& node,
                const std::string& name) {
  const double step = experiment.time.rate * experiment.time.integration_step;
  const double period = schedule_of(experiment, node).period;
  const NodeTicks ticks{run, node};
  const auto longest = static_cast<std::size_t>(std::lround(kMostSteps * step / period));
  const auto& counter = ticks.counter();
  const auto target = run.signal(experiment.roles.new_target);
  std::size_t last = 0, last_row = 0;
  bool has_begun = false;
  for (std::size_t row = 0; row < counter.size(); ++row) {
    has_begun = has_begun || target[row] != 0;
    const auto count = static_cast<std::size_t>(std::lround(std::max(0.0, counter[row])));
    if (count > ticks.count()) return;
    if (count <= last) continue;
    if (has_begun && last > 0 && count - last > longest)
      throw Error{fmt::format(
          "{} has no row from {:.3f} s to {:.3f} s, {:.0f} ms of node '{}', expected gaps of at "
          "most {:.0f} ms",
          name, run.time()[last_row], run.time()[row],
          1e3 * period * static_cast<double>(count - last), node, 1e3 * kMostSteps * step)};
    last = count;
    last_row = row;
  }
}

// Times of the scheduled steps of a node; empty if the recording lacks them.
loop::TickTimes times_of(const Experiment& experiment, const Reader& run, const std::string& node) {
  const auto late = run.meta_series(launch::kLateSeries + node);
  const auto duration = run.meta_series(launch::kDurationSeries + node);
  const Schedule schedule = schedule_of(experiment, node);
  loop::TickTimes times;
  for (std::size_t i = 0; i < std::min(late.values.size(), duration.values.size()); ++i) {
    const bool is_missed = schedule.makes_due && late.values[i] >= schedule.period;
    times.missed.push_back(is_missed);
    times.due.push_back(schedule.phase + static_cast<double>(i) * schedule.period);
    times.begin.push_back(times.due.back() + late.values[i]);
    times.end.push_back(times.begin.back() + duration.values[i]);
  }
  return times;
}

// The ticks in which the targets arrived. The controller shows the time of the last one, so rows
// may be missing; of several targets between two rows, the others arrived in one of the ticks
// between.
std::vector<loop::Arrival> arrivals_of(const Reader& run, const NodeTicks& ticks,
                                       const std::string& monitor, const Schedule& schedule) {
  const auto targets = run.signal(monitor + "pc.targets");
  const std::string target_time = monitor + "pc.target_time";
  const auto time = run.has(target_time) ? run.signal(target_time) : std::vector<double>{};
  const auto skipped = ticks.skipped();
  std::vector<loop::Arrival> arrivals;
  std::size_t last = 0;  // ticks made
  for (std::size_t row = 0; row < targets.size(); ++row) {
    const auto made = static_cast<std::size_t>(std::lround(std::max(0.0, ticks.counter()[row])));
    if (made <= last) continue;
    if (made > ticks.count()) break;
    const std::size_t before = arrivals.size();
    while (static_cast<double>(arrivals.size()) + 1 <= targets[row])
      arrivals.push_back({last, made - 1});
    if (arrivals.size() > before && !time.empty()) {
      const auto at = std::lower_bound(run.time().begin(), run.time().end(), time[row]);
      const auto seen = std::min(static_cast<std::size_t>(at - run.time().begin()), row);
      const double passed = (time[row] - schedule.phase) / schedule.period - skipped[seen];
      const auto tick = std::max(0L, std::lround(passed));
      arrivals.back().first = arrivals.back().last =
          std::clamp(static_cast<std::size_t>(tick), last, made - 1);
    }
    last = made;
  }
  return arrivals;
}

// Whether the targets of a test arrived in time, by tick of the controller.
class Punctuality {
 public:
  /// @param solver_late  by tick of the controller [s]
  Punctuality(std::vector<double> solver_late, const loop::TickTimes& controller, double period)
      : controller_{controller}, solver_{std::move(solver_late)}, period_{period} {}
  [[nodiscard]] bool holds(std::size_t from, std::size_t to) const {
    const auto& begin = controller_.begin;
    for (std::size_t tick = from; tick <= to && tick < begin.size(); ++tick) {
      const double due = begin.front() + static_cast<double>(tick) * period_;
      if (controller_.missed[tick] || begin[tick] - due > period_ / 2 ||
          solver_[std::min(tick, solver_.size() - 1)] > period_ / 2)
        return false;
    }
    return true;
  }

 private:
  const loop::TickTimes& controller_;
  std::vector<double> solver_;
  double period_;
};

// Ticks of the controller from "at target" to the next target. Where the host was late, the median
// takes the place of what was recorded. Returns whether the host was never late.
bool read_computing(const std::vector<double>& at_target, const Punctuality& in_time,
                    const std::vector<loop::Arrival>& arrivals, loop::Host& host) {
  std::vector<int> punctual;
  std::vector<bool> is_punctual;
  for (std::size_t k = 1; k < arrivals.size(); ++k) {
    std::size_t reached = arrivals[k].last;
    while (reached > arrivals[k - 1].last &&
           !(at_target[reached] >= 1 && at_target[reached - 1] < 1))
      --reached;
    host.computing.push_back(static_cast<int>(arrivals[k].last - reached));
    is_punctual.push_back(arrivals[k].first == arrivals[k].last &&
                          in_time.holds(reached, arrivals[k].last));
    if (is_punctual.back()) punctual.push_back(host.computing.back());
  }
  if (punctual.empty()) return false;
  const int middle = maths::median(punctual);
  for (std::size_t k = 0; k < host.computing.size(); ++k)
    if (!is_punctual[k]) host.computing[k] = middle;
  return punctual.size() == host.computing.size();
}

}  // namespace

loop::Host recorded_host(const Experiment& experiment, const Reader& run, const NodeTicks& ticks,
                         double period) {
  const auto& roles = experiment.roles;
  const std::string monitor = roles.monitor_of_controller();
  const auto controller = times_of(experiment, run, roles.controller);
  loop::Host host;
  host.order = loop::order_of(times_of(experiment, run, roles.machine), controller);
  auto arrivals = arrivals_of(run, ticks, monitor, schedule_of(experiment, roles.controller));
  if (!arrivals.empty()) host.first_target = arrivals[0].last;
  const std::string late = "monitor." + roles.solver + ".host.late";
  const Punctuality punctuality{run.has(late) ? ticks.values(late) : std::vector<double>{0},
                                controller, period};
  const bool in_time =
      read_computing(ticks.values(monitor + "pc.at_target"), punctuality, arrivals, host);
  const bool has_times = !controller.begin.empty();
  if (has_times && !(in_time && host.order.machine_before.empty()))
    host.arrivals = std::move(arrivals);
  return host;
}

void check_gaps(const Experiment& experiment, const Reader& run, const std::string& name) {
  check_node(experiment, run, experiment.roles.controller, name);
  check_node(experiment, run, experiment.roles.machine, name);
}

}  // namespace rths::session
