// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <rths/core/clock.hpp>

namespace rths::adapters {

/// A solver that runs beside us as a process of its own, and not longer than we: were we killed, it
/// would for ever read a socket that nobody closes in order.
class Script {
 public:
  /// Starts it, in the folder of the script. What it says goes to a file.
  /// @param command  program, looked for in PATH, script and arguments   @throws Error if it cannot
  /// start
  Script(const std::vector<std::string>& command, const std::filesystem::path& log);
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;
  /// Kills it if it still runs.
  ~Script();

  [[nodiscard]] bool has_ended();
  /// Waits for its end, at most so long. @returns has_ended()
  bool wait(Duration longest);
  /// How it ended if not in order, in words, with the last line that it said.
  [[nodiscard]] std::optional<std::string> trouble() const;

 private:
  std::string name_;
  std::filesystem::path log_;
  int pid_ = -1;
  bool has_ended_ = false;
  int status_ = 0;
};

}  // namespace rths::adapters
