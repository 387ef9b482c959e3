// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include <rths/bench/srmd_bench.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/message.hpp>

#include "commands.hpp"
#include "write_file.hpp"

namespace rths::app {

int bench_srmd(const SrmdBenchArguments& arguments) {
  // Before the measurement, which takes minutes.
  check_result_file(arguments.json);
  if (!arguments.json.empty() && !std::ofstream{arguments.json, std::ios::app})
    throw Error{arguments.json + ": cannot be written"};
  bench::SrmdOptions options;
  options.draws = arguments.draws;
  options.records = arguments.records;
  options.duration = arguments.duration;
  options.machine = shared_files() / "machines/srmd.toml";
  options.bearing = shared_files() / "bearings/lprb.toml";
  options.constants = shared_files() / "examples/srmd_platen_constants.toml";
  options.records_folder = shared_files() / "examples/records";
  options.jobs = arguments.jobs;
  if (!arguments.json.empty()) options.partial = arguments.json + ".partial";
  const bool on_terminal = isatty(STDERR_FILENO) == 1;
  if (on_terminal)
    options.progress = [](const std::string& stage) {
      write_message(fmt::format("\r{:<60}", stage));
    };
  const bench::SrmdReport report = bench::run_srmd_bench(options);
  if (on_terminal) write_message(fmt::format("\r{: <60}\r", ""));
  fmt::print("{}", bench::to_text(report));
  if (arguments.json.empty()) return 0;
  write_file(arguments.json, bench::to_json(report));
  std::filesystem::remove(options.partial);
  return 0;
}

}  // namespace rths::app
