// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <exception>
#include <iterator>

namespace rths {

/// Signals that ask a process to end.
inline constexpr int kEndingSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};

/// Ends a long computation that a signal has interrupted. It is no Error, so that code that goes on
/// after an Error does not go on after it.
class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// During its lifetime, the first signal that asks this process to end is only noted, for
/// `is_interrupted` and `stop_if_interrupted`. A second one ends the process. Signals that were
/// ignored stay ignored. One at a time.
class Interruptible {
 public:
  Interruptible();
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  struct sigaction previous_[std::size(kEndingSignals)] = {};
};

/// Returns true if a signal was noted.   @any_thread
[[nodiscard]] bool is_interrupted() noexcept;

/// For long computations, to be called several times per second. Costs one load.
/// @throws Interrupted if a signal was noted   @any_thread
void stop_if_interrupted();

}  // namespace rths
