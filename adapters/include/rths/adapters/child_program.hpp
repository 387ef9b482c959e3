// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/clock.hpp>

namespace rths::adapters {

/// How to start a program.
struct ProgramStart {
  std::string name;                    ///< in messages
  std::vector<std::string> command;    ///< program, searched in PATH, and its arguments
  std::filesystem::path folder = ".";  ///< in which it runs
  std::filesystem::path log;           ///< its output
  std::string telling;  ///< beginning of the lines that tell of a failure; empty: any line
  /// Variables in addition to those of this process.
  std::vector<std::pair<std::string, std::string>> environment;
  int kept_open = -1;       ///< a descriptor of this process that it inherits; −1: none
  bool is_favoured = true;  ///< by the scheduler, if permitted: every step waits for it
};

/// A user's program in a child process that ends with this process, and so do the processes that it
/// starts. Otherwise they would poll closed sockets, or the words of a finished run, after this
/// process is killed.
class ChildProgram {
 public:
  /// Starts it. The calling thread must live as long as the program.
  /// @throws Error if it cannot start
  explicit ChildProgram(const ProgramStart& start);
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;
  /// Kills it if it still runs.
  ~ChildProgram();

  [[nodiscard]] int process() const { return pid_; }
  [[nodiscard]] bool has_ended();
  /// Asks it to end, by SIGTERM.
  void ask_to_end() const noexcept;
  /// Waits for its end, at most for `longest`. @returns has_ended()
  bool wait(Duration longest);
  /// Describes its failure, if any, with the last line of its output.
  [[nodiscard]] std::optional<std::string> failure() const;

 private:
  void start_guard();
  void end_guard() noexcept;

  std::string name_;
  std::filesystem::path log_;
  std::string telling_;
  int pid_ = -1;
  bool has_ended_ = false;
  int status_ = 0;
  int guard_ = -1;     ///< process that ends the program's group if this process is killed
  int lifeline_ = -1;  ///< pipe to it; closed when this process ends
};

}  // namespace rths::adapters
