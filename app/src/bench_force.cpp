// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <fmt/format.h>

#include <rths/bench/force_bench.hpp>
#include <rths/core/message.hpp>

#include "commands.hpp"
#include "gate_exit.hpp"

namespace rths::app {

int bench_force(const ForceBenchArguments& arguments) {
  bench::ForceOptions options;
  options.seeds = arguments.seeds;
  options.progress = [&](int seed) {
    write_message(fmt::format("\r{} of {}", seed, arguments.seeds));
  };
  const bench::ForceReport report = bench::run_force_bench(options);
  write_message(fmt::format("\r{:20}\r", ""));
  fmt::print("{}", arguments.json ? bench::to_json(report) : bench::to_text(report));
  return exit_code(report.result);
}

}  // namespace rths::app
