// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rths::test {

/// Result of a process.
struct Finished {
  int exit_code = -1;  ///< −1 if killed
  int signal = 0;
  std::string out, err;
  double seconds = 0;       ///< wall time
  double host_seconds = 0;  ///< that the host has granted: see host_time.hpp
};

/// A child process; its destructor kills it if it still runs.
class Running {
 public:
  explicit Running(const std::vector<std::string>& command);
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  [[nodiscard]] int pid() const { return pid_; }
  /// Waits for its exit; kills it after `deadline_s`, of the time that the host grants.
  [[nodiscard]] Finished wait(double deadline_s = 60);

 private:
  void read_available();
  int pid_ = -1;
  int out_ = -1, err_ = -1;
  Finished finished_;
};

/// Returns an unused port of this computer.
[[nodiscard]] std::uint16_t free_port();

/// Runs `rths` of this build.
[[nodiscard]] Finished run_rths(const std::vector<std::string>& arguments, double deadline_s = 60);
[[nodiscard]] std::string rths_command();
/// Whether a process exists and has not exited.
[[nodiscard]] bool is_running(int pid);
/// Processor time that a process has used [s].
[[nodiscard]] double processor_time_of(int pid);
/// Process ids of the direct children of a process.
[[nodiscard]] std::vector<int> children_of(int pid);
/// The children that run another program than their parent: not copies of it, such as guards.
[[nodiscard]] std::vector<int> programs_of(int pid);
/// Command line of a process, with its words separated by spaces.
[[nodiscard]] std::string command_line_of(int pid);

}  // namespace rths::test
