// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <fmt/format.h>

#include <rths/command_line/write_file.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/recording/excerpt.hpp>
#include <rths/session/folder.hpp>

#include "commands.hpp"
#include "patterns.hpp"

namespace rths::app {

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

}  // namespace rths::app
