// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <fmt/format.h>

#include <rths/bench/opensees_bench.hpp>

#include "commands.hpp"
#include "gate_exit.hpp"

namespace rths::app {

int bench_opensees(const OpenSeesBenchArguments& arguments) {
  bench::OpenSeesBenchOptions options;
  options.cycles = arguments.cycles;
  options.round_trips = arguments.round_trips;
  options.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const bench::OpenSeesBenchReport report = bench::run_opensees_bench(options);
  fmt::print("{}", arguments.json ? bench::to_json(report) : bench::to_text(report));
  return exit_code(report.result);
}

}  // namespace rths::app
