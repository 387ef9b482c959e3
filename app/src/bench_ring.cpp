// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include <rths/bench/ring_bench.hpp>
#include <rths/core/message.hpp>

#include "commands.hpp"
#include "gate_exit.hpp"

namespace rths::app {
namespace {

// Overwrites one terminal line. The caller checks for a terminal.
void show_row(int cycle, const std::string& row) {
  write_message(fmt::format("\rcycle {}: {:<40}", cycle + 1, row));
}

}  // namespace

int bench_ring(const RingBenchArguments& arguments) {
  bench::Options options;
  options.cycles = arguments.cycles;
  options.round_trips = arguments.round_trips;
  options.seed = arguments.seed;
  options.rows = arguments.rows;
  options.keep = arguments.keep;
  options.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const bool on_terminal = isatty(STDERR_FILENO) == 1;
  if (on_terminal) options.progress = show_row;
  const bench::Report report = bench::run_ring_bench(options);
  if (on_terminal) write_message(fmt::format("\r{: <60}\r", ""));
  fmt::print("{}", arguments.json ? bench::to_json(report) : bench::to_text(report));
  return exit_code(report.result);
}

std::vector<std::string> bench_rows() {
  std::vector<std::string> names;
  for (const auto& row : bench::all_rows()) names.push_back(row.name);
  return names;
}

}  // namespace rths::app
