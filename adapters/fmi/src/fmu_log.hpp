// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <string>

namespace rths::fmi {

/// Status of a call, with the numbers of both versions of the standard.
enum FmiStatus : int { kOk, kWarning, kDiscard, kError, kFatal, kPending };

/// Messages of an FMU. They go to standard error with the name of the instance. Those of a step are
/// kept, and printed by `flush`.
class FmuLog {
 public:
  void rename(const std::string& instance) { instance_ = instance; }

  /// Any thread. Of two threads at once, one loses its message.   @realtime during steps
  void add(int status, const char* category, const char* message) noexcept;
  /// From now on, messages are kept.
  void begin_steps() noexcept;
  /// Prints what was kept; later messages are printed at once.   @setup
  void flush();
  /// The last message of an error or a refusal; empty without one.
  [[nodiscard]] const char* last_error() const noexcept { return last_error_.data(); }
  void forget_error() noexcept { last_error_[0] = '\0'; }

 private:
  using Text = std::array<char, 240>;
  void lock() noexcept;

  std::string instance_;
  std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
  bool keeps_ = false;
  std::array<Text, 64> kept_{};
  std::size_t count_ = 0, lost_ = 0;
  Text last_error_{};
};

}  // namespace rths::fmi
