// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rths::launch {

/// A child process that exchanges lines with this process through its standard input and output. It
/// inherits standard error.
class ChildProcess {
 public:
  /// Starts this program with other arguments. @throws Error if that fails   @setup
  explicit ChildProcess(const std::vector<std::string>& arguments);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// Kills the process if it still runs, and reaps it.
  ~ChildProcess();

  [[nodiscard]] int pid() const { return pid_; }
  /// Descriptor to poll: readable when a line arrives or the process ends.
  [[nodiscard]] int output() const { return output_; }
  [[nodiscard]] bool ended() const { return ended_; }
  /// How the process ended, as text: "exited with 2", "was killed by signal 9".
  [[nodiscard]] std::string ending() const;
  /// True if it exited with 0.
  [[nodiscard]] bool succeeded() const;

  /// Sends a line; does nothing if the process has ended. The line is lost if the process has not
  /// read the last thousands of lines.
  void send_line(const std::string& line) noexcept;
  /// Returns the next complete line, if any. Detects the end of the process.
  [[nodiscard]] std::optional<std::string> read_line();

 private:
  void collect() noexcept;
  int pid_ = -1;
  int input_ = -1, output_ = -1;
  bool ended_ = false;
  int status_ = 0;
  std::string received_;
};

}  // namespace rths::launch
