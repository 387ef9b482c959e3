// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rths::launch {

/// A process of ours that listens on its standard input and answers on its standard output, line by
/// line. Its standard error is ours.
class ChildProcess {
 public:
  /// Starts this very program with other arguments. @throws Error if it cannot be started   @setup
  explicit ChildProcess(const std::vector<std::string>& arguments);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// Kills it if it still runs, and collects it.
  ~ChildProcess();

  [[nodiscard]] int pid() const { return pid_; }
  /// To be polled for readability: a line has come, or the process has ended.
  [[nodiscard]] int output() const { return output_; }
  [[nodiscard]] bool ended() const { return ended_; }
  /// How it ended, in words: "exited with 2", "was killed by signal 9".
  [[nodiscard]] std::string ending() const;
  /// True if it exited with 0.
  [[nodiscard]] bool succeeded() const;

  /// Sends a line; a process that has gone is not written to.
  void say(const std::string& line) noexcept;
  /// Next complete line, if one has come. Notices the process' end.
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
