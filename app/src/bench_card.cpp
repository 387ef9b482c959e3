// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/bench/card_bench.hpp>

#include "commands.hpp"
#include "gate_exit.hpp"

namespace rths::app {

int bench_card(const CardBenchArguments& arguments) {
  const bench::CardReport report =
      bench::run_card_bench({.passes = arguments.passes, .seconds = arguments.seconds});
  fmt::print("{}", arguments.json ? bench::to_json(report) : bench::to_text(report));
  return exit_code(report.result);
}

}  // namespace rths::app
