// SPDX-License-Identifier: Apache-2.0
#include "recorded_host.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/recording/roles.hpp>

namespace rths::session {
namespace {

using experiment::NodePlan;
using recording::NodeTicks;
using recording::Reader;

constexpr double kMostSteps = 5;  // of integration, in a gap

double period_of(const Experiment& experiment, const std::string& node) {
  const auto plan = std::find_if(experiment.nodes.begin(), experiment.nodes.end(),
                                 [&](const NodePlan& one) { return one.node == node; });
  constexpr double kUsual = 0.001;  // [s]
  return plan == experiment.nodes.end() ? kUsual : to_seconds(plan->schedule.period);
}

void check_node(const Experiment& experiment, const Reader& run, const std::string& node,
                const std::string& name) {
  const double step = experiment.time.rate * experiment.time.integration_step;
  const double period = period_of(experiment, node);
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

}  // namespace

void check_gaps(const Experiment& experiment, const Reader& run, const std::string& name) {
  check_node(experiment, run, experiment.roles.controller, name);
  check_node(experiment, run, experiment.roles.machine, name);
}

}  // namespace rths::session
