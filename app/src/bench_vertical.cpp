// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <fmt/format.h>

#include <rths/bench/vertical_bench.hpp>
#include <rths/core/message.hpp>

#include "commands.hpp"
#include "gate_exit.hpp"

namespace rths::app {

int bench_vertical(const VerticalBenchArguments& arguments) {
  bench::VerticalOptions options;
  options.draws = arguments.draws;
  options.duration = arguments.duration;
  options.progress = [&](int draw) {
    write_message(fmt::format("\r{} of {}", draw, arguments.draws));
  };
  const bench::VerticalReport report = bench::run_vertical_bench(options);
  write_message(fmt::format("\r{:20}\r", ""));
  fmt::print("{}", arguments.json ? bench::to_json(report) : bench::to_text(report));
  return exit_code(report.result);
}

}  // namespace rths::app
