// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/broker/follow.hpp>
#include <rths/core/error.hpp>

#include "ring_handle.hpp"

namespace rths::python {

/// A follower was more than a journal behind.
class LostWrites : public Error {
 public:
  using Error::Error;
};

/// One write to followed signals: a word, or all followed words of a tear group.
struct Change {
  std::string node;                                    ///< the writer
  std::vector<std::pair<std::string, double>> values;  ///< [SI]
};

/// Waits for the writes to given signals, each once and in its writer's order, beginning now.
class Follower {
 public:
  /// @throws Error for an unknown signal, or if there are none
  Follower(std::shared_ptr<RingHandle> ring, const std::vector<std::string>& signals);

  /// The next write; empty if there is none within the time. Releases Python's global lock while it
  /// waits, and ends early if Python has a signal to handle.
  /// @param timeout_s  0 to a million [s]
  /// @throws LostWrites and continues at the newest write; Error if another thread is waiting
  [[nodiscard]] std::optional<Change> wait(double timeout_s);

 private:
  [[nodiscard]] Change change_of(const broker::Write& write);

  std::shared_ptr<RingHandle> ring_;  // before the waiter, which is on the ring
  std::vector<const memmap::SignalEntry*> entries_;
  std::optional<broker::Waiter> waiter_;
  bool is_waiting_ = false;
};

}  // namespace rths::python
