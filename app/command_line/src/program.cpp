// SPDX-License-Identifier: Apache-2.0
#include <rths/command_line/program.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/message.hpp>

#include "command_line.hpp"

namespace rths::app {
namespace {

int failed(const std::string& name, const std::string& text, ExitCode code) {
  write_message(fmt::format("{}: {}\n", name, text));
  return code;
}

// A closed standard stream would get the number of the next file that is opened, which messages
// would then overwrite.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0)  // NOLINT(cppcoreguidelines-pro-type-vararg)
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
      static_cast<void>(open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY));
}

// Why a command ended that could not write its results to standard output, or failed otherwise.
std::string reason_of(const std::exception& error) {
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  if (system == nullptr || std::ferror(stdout) == 0) return error.what();
  return "standard output cannot be written: " + system->code().message();
}

// The exit code of a command whose standard output may be lost: a full disk.
int with_output(const std::string& name, int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  const std::string reason = std::strerror(errno);
  failed(name, "standard output cannot be written: " + reason, kFailure);
  return code == kOk ? kFailure : code;
}

// For the shell's completion and for the installation; not in the help.
std::optional<int> run_hidden(const Program& program, const std::vector<std::string>& words) {
  if (words.empty() || (words[0] != "complete" && words[0] != "manual")) return std::nullopt;
  if (words[0] == "manual")
    fmt::print("{}", manual_page(program.commands, program.version));
  else
    fmt::print("{}\n", fmt::join(completions(program, {words.begin() + 1, words.end()}), "\n"));
  return kOk;
}

// The help of the innermost command that was given.
std::string usage_hint(const CLI::App& app) {
  std::string command = app.get_name();
  for (const auto* inner = &app; !inner->get_subcommands().empty();) {
    inner = inner->get_subcommands().front();
    command += " " + inner->get_name();
  }
  return fmt::format("; see {} --help", command);
}

}  // namespace

int run(const Program& program, int argc, char** argv) {
  CLI::App& app = program.commands;
  refuse_nan(app);
  const std::vector<std::string> words{argv + 1, argv + argc};
  if (const auto result = run_hidden(program, words)) return *result;
  try {
    check_command_names(app, words);
    app.parse(argc, argv);
  } catch (const Error& error) {
    return failed(app.get_name(), error.what(), kUsage);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help or version
    return failed(app.get_name(), printable(error.what()) + usage_hint(app), kUsage);
  }
  return program.chosen();
}

int guarded(const std::string& name, const std::function<int()>& work) {
  try {
    open_standard_streams();
    return with_output(name, work());
  } catch (const Interrupted& interrupted) {
    return failed(name, interrupted.what(), kConditionNotMet);
  } catch (const Error& error) {
    return failed(name, error.what(), kFailure);
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(name, printable(error.path1().string() + ": " + error.code().message()),
                  kFailure);
  } catch (const std::exception& error) {
    return failed(name, printable(reason_of(error)), kFailure);
  }
}

}  // namespace rths::app
