// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/bench/bridge_bench.hpp>

#include "commands.hpp"
#include "gate_exit.hpp"

namespace rths::app {

int bench_bridge(const BridgeBenchArguments& arguments) {
  bench::BridgeBenchOptions options;
  options.cycles = arguments.cycles;
  options.updates = arguments.updates;
  options.domain = arguments.domain;
  const bench::BridgeBenchReport report = bench::run_bridge_bench(options);
  fmt::print("{}", arguments.json ? bench::to_json(report) : bench::to_text(report));
  return exit_code(report.result);
}

}  // namespace rths::app
