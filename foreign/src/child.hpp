// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rths::foreign {

/// How a program ended.
struct ChildEnding {
  std::string trouble;   ///< "ended with exit code 2"; empty: exit code 0
  std::string messages;  ///< the end of what it wrote to standard output and error
};

/// Runs a program in a folder, in a process group of its own, with empty standard input, until it
/// ends or the deadline passes. Then no process of the group is left.
/// @param command   full path of the program, and its arguments
/// @param deadline  [s]
/// @throws Error if there is no process for it; Interrupted   @any_thread
[[nodiscard]] ChildEnding run_child(const std::vector<std::string>& command,
                                    const std::filesystem::path& folder, double deadline);

}  // namespace rths::foreign
