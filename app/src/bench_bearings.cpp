// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include <rths/bench/bearing_bench.hpp>
#include <rths/core/message.hpp>

#include "commands.hpp"
#include "gate_exit.hpp"
#include "opensees_python.hpp"

namespace rths::app {
namespace {

namespace fs = std::filesystem;

void show(const std::string& progress) { write_message(fmt::format("\r{:<60}", progress)); }

}  // namespace

int bench_bearings(const BearingBenchArguments& arguments) {
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  const fs::path shared = programs / "../share/rths";
  bench::BearingOptions options;
  options.passes = arguments.passes;
  options.steps = arguments.steps;
  options.opensees_steps = std::min(options.opensees_steps, arguments.steps);
  options.bearings = shared / "bearings";
  options.script = shared / "opensees/bearing.py";
  options.python = opensees_python(arguments.opensees, programs);
  const bool on_terminal = isatty(STDERR_FILENO) == 1;
  if (on_terminal) options.progress = show;
  const bench::BearingReport report = bench::run_bearing_bench(options);
  if (on_terminal) write_message(fmt::format("\r{: <60}\r", ""));
  fmt::print("{}", arguments.json ? bench::to_json(report) : bench::to_text(report));
  return exit_code(report.result);
}

}  // namespace rths::app
