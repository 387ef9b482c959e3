// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/bearing_bench.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/bench/load.hpp>
#include <rths/bench/partner.hpp>
#include <rths/bench/stamp.hpp>
#include <rths/core/config.hpp>

#include "specimens.hpp"

namespace rths::bench {
namespace {

constexpr int kBearingsOfPlant = 486;

// The composition of a file. @param vertical  enables the vertical terms, which tests of two axes
// leave out
sim::Composition read_bearing(const std::filesystem::path& file, bool vertical) {
  Config bearing = Config::load(file);
  if (vertical)
    for (const auto& term : bearing.keys())
      if (bearing.is_table(term)) bearing.set(term + ".enabled", "true");
  return {sim::read_terms(bearing), kTimeStep};
}

BearingResult measure(const Specimen& specimen, const BearingOptions& options, double tick) {
  const auto report = [&](const char* stage) {
    if (options.progress) options.progress(fmt::format("{}: {}", specimen.name, stage));
  };
  const sim::Composition composition =
      read_bearing(options.bearings / (specimen.name + ".toml"), specimen.vertical);
  const Shaking shaking = earthquake(specimen.demand, options.steps);
  BearingResult result;
  result.name = specimen.name;
  result.title = specimen.title;
  result.goal = specimen.goal;
  for (const auto& term : composition.terms()) result.terms.push_back(term.name);
  report("earthquake");
  result.earthquake = step_times(composition, shaking, options.passes, tick);
  report("adversity");
  result.adversarial =
      step_times(composition, adversity(specimen.demand, options.steps), options.passes, tick);
  report("derivatives");
  result.dual_ratio = dual_ratio(composition, shaking, options.passes, tick);
  report("many");
  const Shaking beginning{shaking.begin(), shaking.begin() + std::min(options.steps, 2'000)};
  result.in_loop = loop_time(composition, beginning, kBearingsOfPlant, tick);
  report("OpenSees");
  const Shaking theirs =
      earthquake(specimen.demand, std::min(options.opensees_steps, options.steps));
  result.opensees =
      opensees_times({options.python, options.script}, specimen.opensees, theirs, kTimeStep);
  return result;
}

// A missed goal is inconclusive if the machine was not quiet.
GateResult gate_result_of(const BearingResult& result, bool quiet) {
  if (result.goal == 0) return GateResult::NotJudged;
  if (result.earthquake.p50 <= result.goal) return GateResult::Pass;
  return quiet ? GateResult::Fail : GateResult::Inconclusive;
}

}  // namespace

BearingReport run_bearing_bench(const BearingOptions& options) {
  BearingReport report;
  report.machine = describe_machine();
  report.passes = options.passes;
  report.steps = options.steps;
  const double tick = measure_tick();
  const Cpus cpus = report.machine.chosen ? report.machine.chosen->cpus : Cpus{};
  const LoadMeter meter{cpus};
  {
    const Pinned pinned{cpus.near};
    for (const Specimen& specimen : all_specimens())
      report.bearings.push_back(measure(specimen, options, tick));
  }
  const Load load = meter.so_far();
  if (!is_quiet(load))
    report.troubles.push_back(
        fmt::format("other processes used {:.0f} % of the processors, the host {:.0f} %",
                    100 * load.other, 100 * load.steal));
  for (auto& result : report.bearings)
    result.gate_result = gate_result_of(result, report.troubles.empty());
  report.result = worst_of(report.bearings);
  return report;
}

}  // namespace rths::bench
