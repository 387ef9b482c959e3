// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/command_line/write_file.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/recording/excerpt.hpp>
#include <rths/session/folder.hpp>

#include "command.hpp"
#include "commands.hpp"
#include "patterns.hpp"

namespace rths::app {
namespace {

struct ExportArguments {
  std::string recording;              ///< file, or folder of a run
  std::vector<std::string> patterns;  ///< signal names; * and ? as in a shell; empty: all
  double from = -std::numeric_limits<double>::infinity();  ///< first time [s]
  double to = std::numeric_limits<double>::infinity();     ///< last time [s]
  std::string format = "csv";                              ///< csv or mat
  std::string out;  ///< file; empty: name of the recording, in the current folder
};

int export_table(const ExportArguments& arguments) {
  const std::filesystem::path source = session::recording_in(arguments.recording);
  const recording::Reader reader{source};
  const std::filesystem::path target =
      arguments.out.empty() ? source.stem().string() + "." + arguments.format : arguments.out;
  std::error_code ignored;
  if (std::filesystem::equivalent(source, target, ignored))
    throw Error{target.string() + ": is the recording itself, expected another file (--out)"};
  check_result_file(target);
  const Interruptible interruptible;
  const auto excerpt =
      recording::make_excerpt(reader, selected(reader.names(), arguments.patterns, source.string()),
                              arguments.from, arguments.to);
  if (arguments.format == "mat")
    recording::write_mat(excerpt, target);
  else
    recording::write_csv(excerpt, target);
  fmt::print("table     {}\n{} rows of {} signals, {:.3f} to {:.3f} s\n", target.string(),
             excerpt.time.size(), excerpt.names.size(), excerpt.time.front(), excerpt.time.back());
  return kOk;
}

}  // namespace

void add_export(CommandLine& line) {
  auto& a = line.values<ExportArguments>();
  auto* command = line.app.add_subcommand(
      "export", "Write signals of a recording as a table: one row per time, SI units");
  command->add_option("recording", a.recording, "Recording, or folder of a run")->required();
  command->add_option("--signals", a.patterns, "Signal names; * and ? as in a shell [all]");
  command->add_option("--from", a.from, "First time [s]");
  command->add_option("--to", a.to, "Last time [s]");
  command->add_option("--format", a.format)->check(CLI::IsMember({"csv", "mat"}));
  command->add_option("--out", a.out, "File [name of the recording, in this folder]");
  command->callback([&] { line.chosen = [&a] { return export_table(a); }; });
}

}  // namespace rths::app
