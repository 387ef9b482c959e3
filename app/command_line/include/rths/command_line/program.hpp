// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rths::app {

/// The chosen subcommand; runs after the command line is parsed.
using Chosen = std::function<int()>;

/// Exit codes of a program.
enum ExitCode { kOk = 0, kConditionNotMet = 1, kFailure = 2, kUsage = 3 };

/// A thousand times it is still a number of 64 bits.
inline constexpr std::int64_t kLargestSeed = 1'000'000'000'000'000;

/// Values of an option that a shell may complete, beside those of its check.
/// @param option  its name
/// @param source  first positional word of the command line; empty: none yet
using Candidates =
    std::function<std::vector<std::string>(const std::string& option, const std::string& source)>;

/// A program: its commands, and the one that its command line has chosen.
struct Program {
  CLI::App& commands;
  const Chosen& chosen;
  std::string version;
  Candidates candidates = {};  ///< none: options have only those of their checks
};

/// Runs the command that the words choose. The hidden command `complete` prints candidates for the
/// last word, for a shell; `manual` prints the manual page, in the format of man(7). Options with a
/// number refuse nan. Wrong usage is printed in one line.
/// @returns an exit code
/// @throws as the command
[[nodiscard]] int run(const Program& program, int argc, char** argv);

/// `main` of a program: prints an error in one line on standard error, after the name.
/// @returns the exit code of `work`, or of its error; kFailure if standard output was lost
[[nodiscard]] int guarded(const std::string& name, const std::function<int()>& work);

}  // namespace rths::app
