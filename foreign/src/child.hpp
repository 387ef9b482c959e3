// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rths::foreign {

/// How a program ended.
struct ChildEnding {
  std::string trouble;   ///< "ended with exit code 2"; empty: exit code 0
  std::string messages;  ///< the end of what it wrote to standard output and error
};

/// Trouble and messages in one line. @param title  of the program
[[nodiscard]] std::string told(const std::string& title, const ChildEnding& ending);

inline constexpr int kLookMilliseconds = 100;  ///< between looks for an interrupt

/// File of what a program writes to standard output and error, in the folder of its run.
inline constexpr const char* kMessages = "messages.txt";

/// @param status    as from waitpid
/// @param deadline  that has passed [s]; none: it ended by itself
[[nodiscard]] ChildEnding ending_of(int status, std::optional<double> deadline,
                                    const std::filesystem::path& folder);

/// Runs a program in a folder, in a process group of its own, with empty standard input, until it
/// ends or the deadline passes. Then no process of the group is left.
/// @param command   full path of the program, and its arguments
/// @param deadline  [s]
/// @throws Error if there is no process for it; Interrupted   @any_thread
[[nodiscard]] ChildEnding run_child(const std::vector<std::string>& command,
                                    const std::filesystem::path& folder, double deadline);

/// Runs a function in a fork of this process, in the same way. What the function throws is the
/// trouble. It shares no memory with this process, except what is mapped as shared.
[[nodiscard]] ChildEnding run_forked(const std::function<void()>& work,
                                     const std::filesystem::path& folder, double deadline);

/// Numbers that a fork of this process may write for it.
class SharedNumbers {
 public:
  /// @throws Error if there is no memory
  explicit SharedNumbers(std::size_t count);
  ~SharedNumbers();
  SharedNumbers(const SharedNumbers&) = delete;
  SharedNumbers& operator=(const SharedNumbers&) = delete;

  [[nodiscard]] double* data() const { return data_; }

 private:
  double* data_;
  std::size_t bytes_;
};

/// A temporary folder for one run, removed at its end.
class TemporaryRun {
 public:
  /// @throws Error if it cannot be made
  TemporaryRun();
  ~TemporaryRun();
  TemporaryRun(const TemporaryRun&) = delete;
  TemporaryRun& operator=(const TemporaryRun&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// @throws Error if it cannot be written
  void write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

}  // namespace rths::foreign
