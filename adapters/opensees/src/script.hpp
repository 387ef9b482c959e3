// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <rths/core/clock.hpp>

namespace rths::adapters {

/// A solver in a child process that ends with this process. Otherwise OpenSees would poll its
/// closed socket indefinitely after this process is killed.
class Script {
 public:
  /// Starts it in the folder of the script, with its output in a file.
  /// @param command  program (searched in PATH), script and arguments
  /// @throws Error if it cannot start
  Script(const std::vector<std::string>& command, const std::filesystem::path& log);
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;
  /// Kills it if it still runs.
  ~Script();

  [[nodiscard]] int process() const { return pid_; }
  [[nodiscard]] bool has_ended();
  /// Waits for its end, at most for `longest`. @returns has_ended()
  bool wait(Duration longest);
  /// Describes its failure, if any, with the last line of its output.
  [[nodiscard]] std::optional<std::string> failure() const;

 private:
  std::string name_;
  std::filesystem::path log_;
  int pid_ = -1;
  bool has_ended_ = false;
  int status_ = 0;
};

}  // namespace rths::adapters
