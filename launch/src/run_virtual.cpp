// SPDX-License-Identifier: Apache-2.0
//
// A run in virtual time: all adapters in this process, on a ring in private memory, stepped in the
// order of their due times. Nothing reads a clock, so the same experiment gives the same bits.
#include "run_modes.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::launch {
namespace {

constexpr Duration kProgressPeriod = std::chrono::milliseconds{500};

struct Runner {
  const Station* station;
  adapters::AdapterRunner runner;
  Duration due;
  bool finished = false;
};

Runner* next_due(std::vector<Runner>& runners) {
  Runner* next = nullptr;
  for (auto& runner : runners)
    if (!runner.finished && (next == nullptr || runner.due < next->due)) next = &runner;
  return next;
}

class VirtualRun {
 public:
  VirtualRun(const Experiment& experiment, Assembly& assembly, const RunOptions& options)
      : experiment_{experiment}, options_{options}, ring_{broker::Ring::in_process(assembly.map)} {
    for (auto& station : assembly.stations) {
      station.adapter->activate();
      runners_.push_back(
          {&station,
           adapters::AdapterRunner{*station.adapter, ring_, station.plan.node, assembly.map.hash(),
                                   station.plan.schedule.period},
           station.plan.schedule.phase, false});
    }
  }

  std::string run() {
    if (options_.started) options_.started();
    while (Runner* runner = next_due(runners_)) {
      const Status status = runner->runner.tick(runner->due, stopping_since_.has_value(), {});
      if (status == Status::Done || status == Status::Fault) end(*runner, status);
      if (stopping_since_ && runner->due > *stopping_since_ + longest_stop(experiment_))
        return "a node did not come to rest";
      report_progress(runner->due);
      runner->due += runner->station->plan.schedule.period;
    }
    return trouble_;
  }

 private:
  void end(Runner& runner, Status status) {
    runner.finished = true;
    if (!stopping_since_) stopping_since_ = runner.due;
    if (status == Status::Fault && trouble_.empty())
      trouble_ = fmt::format("{}: {} at {:.3f} s", runner.station->plan.node,
                             runner.runner.message(), to_seconds(runner.due));
  }

  void report_progress(Duration now) {
    if (!options_.progress || now < next_progress_) return;
    next_progress_ = now + kProgressPeriod;
    options_.progress({to_seconds(now) / experiment_.rate, experiment_.duration});
  }

  const Experiment& experiment_;
  const RunOptions& options_;
  broker::Ring ring_;
  std::vector<Runner> runners_;
  std::optional<Duration> stopping_since_;
  Duration next_progress_{0};
  std::string trouble_;
};

}  // namespace

std::string run_in_virtual_time(const Experiment& experiment, Assembly& assembly,
                                const RunOptions& options) {
  const bool ends =
      std::any_of(experiment.nodes.begin(), experiment.nodes.end(), [](const NodePlan& plan) {
        return plan.adapter == "numerical" || plan.adapter == "opensees";
      });
  if (!ends)
    throw Error{
        experiment.file.string() +
        ": no node has the adapter 'numerical' or 'opensees', expected one to end a run in virtual "
        "time"};
  std::string trouble = VirtualRun{experiment, assembly, options}.run();
  for (auto& station : assembly.stations) {
    try {
      station.adapter->deactivate();
    } catch (const Error& error) {
      if (trouble.empty()) trouble = fmt::format("{}: {}", station.plan.node, error.what());
    }
  }
  return trouble;
}

}  // namespace rths::launch
