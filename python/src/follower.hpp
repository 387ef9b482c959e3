// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/error.hpp>

#include <rths/testkit/signals.hpp>

namespace rths::python {

/// A follower was more than a journal behind.
class LostWrites : public Error {
 public:
  using Error::Error;
};

/// Waits for the writes to given signals, each once and in its writer's order, beginning now.
class Follower {
 public:
  /// @throws Error for an unknown signal, or if there are none
  Follower(const std::shared_ptr<testkit::SignalRing>& ring,
           const std::vector<std::string>& signals)
      : follower_{ring->follow(signals)} {}

  /// The next write; empty if there is none within the time. Releases Python's global lock while it
  /// waits, and ends early if Python has a signal to handle.
  /// @param timeout_s  0 to a million [s]
  /// @throws LostWrites and continues at the newest write; Error if another thread is waiting
  [[nodiscard]] std::optional<testkit::Change> wait(double timeout_s);

 private:
  std::unique_ptr<testkit::SignalFollower> follower_;
  bool is_waiting_ = false;
};

}  // namespace rths::python
