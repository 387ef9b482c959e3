// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/ring_bench.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "cycle_file.hpp"

namespace rths::bench {
namespace {

Outcome measure(const Row& row, const Workbench& bench) {
  try {
    return {row.measure(row, bench), ""};
  } catch (const Missing& missing) {
    return {std::nullopt, missing.what()};
  } catch (const Error& error) {
    // A peer that fails is skipped; a row of ours that fails ends the run.
    if (row.is_peers()) return {std::nullopt, error.what()};
    throw Error{fmt::format("row '{}': {}", row.name, error.what())};
  }
}

Cycle measure_cycle(int number, const std::vector<Row>& rows, const Workbench& bench,
                    const RingOptions& options) {
  Cycle cycle;
  const LoadMeter meter{bench.setup.cpus};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // Every second cycle in reverse order, so that a drift of the machine favours no row.
    const Row& row = rows[number % 2 == 0 ? i : rows.size() - 1 - i];
    if (options.progress) options.progress(fmt::format("cycle {}: {}", number + 1, row.name));
    cycle.outcomes[row.name] = measure(row, bench);
  }
  cycle.load = meter.so_far();
  return cycle;
}

std::vector<Cycle> measure_cycles(const std::vector<Row>& rows, const Workbench& bench,
                                  const RingOptions& options) {
  std::vector<Cycle> cycles;
  for (int number = 0; number < options.cycles; ++number) {
    const CycleFile file{options.keep, number, options.round_trips};
    if (auto kept = file.read(rows)) {
      cycles.push_back(std::move(*kept));
      continue;
    }
    cycles.push_back(measure_cycle(number, rows, bench, options));
    file.write(cycles.back());
  }
  return cycles;
}

}  // namespace

RingReport run_ring_bench(const RingOptions& options) {
  const std::vector<Row> rows = select_rows(options.rows);
  RingReport report;
  report.machine = describe_machine();
  report.round_trips = options.round_trips;
  report.seed = options.seed;
  std::vector<Cycle> cycles;
  if (report.machine.chosen) {
    const Setup setup{report.machine.chosen->cpus, options.round_trips, measure_tick()};
    cycles = measure_cycles(rows, {setup, options.programs}, options);
  }
  report.cycles = static_cast<int>(cycles.size());
  for (const Row& row : rows) report.rows.push_back(judge_row(row, cycles, options.seed));
  report.raw = raw_spread(rows, cycles);
  report.troubles = troubles(report.machine, cycles, report.rows, report.raw);
  report.result = overall(report.rows, report.troubles);
  return report;
}

}  // namespace rths::bench
