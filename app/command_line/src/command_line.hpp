// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/command_line/program.hpp>

namespace rths::app {

/// Checks that the first words name commands, which CLI11 reports less clearly.
/// @throws Error naming the commands that exist
void check_command_names(const CLI::App& app, const std::vector<std::string>& words);

/// Makes options with a number refuse nan. A range accepts it, because no comparison excludes it.
void refuse_nan(CLI::App& app);

/// Candidates for the last of these words, which may be incomplete; for the shell.
/// @param words  without the program's name
[[nodiscard]] std::vector<std::string> completions(const Program& program,
                                                   const std::vector<std::string>& words);

/// The manual page of all commands, in the format of man(7). It is named as the program, with
/// hyphens.
[[nodiscard]] std::string manual_page(const CLI::App& app, const std::string& version);

}  // namespace rths::app
