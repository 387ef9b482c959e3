// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <cstddef>
#include <exception>

namespace rths {

/// Ends a long computation that a signal has interrupted. It is no Error, so that code that goes on
/// after an Error does not go on after it.
class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// During its lifetime, the first signal that asks this process to end is only noted, for
/// `stop_if_interrupted`. A second one ends the process. Signals that were ignored stay ignored.
/// One at a time.
class Interruptible {
 public:
  Interruptible();
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  static constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};
  static constexpr std::size_t kCount = sizeof kSignals / sizeof kSignals[0];
  struct sigaction previous_[kCount] = {};
};

/// For long computations, to be called several times per second. Costs one load.
/// @throws Interrupted if a signal was noted   @any_thread
void stop_if_interrupted();

}  // namespace rths
