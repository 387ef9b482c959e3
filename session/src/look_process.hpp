// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace rths::session {

/// When a child process runs, reads and writes.
enum class Priority {
  Idle,  ///< when no other process wants to; it is the first to end if memory is short
  Usual
};

/// Work in a child process that ends with this process. The work shares this process's memory as it
/// was at the start, but not its locks.
class LookProcess {
 public:
  /// @param work  its result is that of the child; what it throws must not leave it
  /// @throws Error if there is no process or no pipe   @setup
  LookProcess(Priority priority, const std::function<std::string()>& work);
  /// Asks a child that still runs to end, and kills it and its children after two seconds.
  ~LookProcess();
  LookProcess(const LookProcess&) = delete;
  LookProcess& operator=(const LookProcess&) = delete;

  /// Readable when there is a result, or when the child has ended.
  [[nodiscard]] int output() const { return output_; }
  /// Reads what is there. @returns the result once it is complete; empty if the child has ended
  /// without one; nothing before
  [[nodiscard]] std::optional<std::string> read_result();

 private:
  int pid_ = -1, output_ = -1;
  std::string text_;
};

}  // namespace rths::session
