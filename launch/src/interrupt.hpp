// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <cstddef>

namespace rths::launch {

/// Asks a run to end in order, as at the end of its duration.
inline constexpr int kStopSignal = SIGUSR1;

/// During its lifetime, signals that ask this process to end are only noted.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  /// True if a signal has come since the last guard began.
  [[nodiscard]] static bool is_interrupted();
  /// True if the stop signal has come since then.
  [[nodiscard]] static bool is_stop_requested();
  /// True if either has come. Before the start, a request to stop is an interruption.
  [[nodiscard]] static bool is_called_off();

 private:
  static constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, kStopSignal};
  static constexpr std::size_t kCount = sizeof kSignals / sizeof kSignals[0];
  struct sigaction previous_[kCount] = {};
};

}  // namespace rths::launch
