// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <thread>

#include <rths/core/clock.hpp>

namespace rths::test {

/// Waits for a condition. @returns false if it is not true in time
template <class Condition>
[[nodiscard]] bool comes_true(const Condition& condition,
                              Duration patience = std::chrono::seconds{10}) {
  const WallClock clock;
  const TimePoint deadline = clock.now() + patience;
  while (!condition()) {
    if (clock.now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds{2});
  }
  return true;
}

}  // namespace rths::test
