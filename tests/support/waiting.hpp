// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <thread>

#include <rths/core/clock.hpp>

#include "support/host_time.hpp"

namespace rths::test {

/// Waits for a condition. @returns false if it is not true in time
/// @param patience  of the time that the host grants: a busy host gets more
template <class Condition>
[[nodiscard]] bool comes_true(const Condition& condition,
                              Duration patience = std::chrono::seconds{10}) {
  const double deadline = host_time() + to_seconds(patience);
  while (!condition()) {
    if (host_time() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds{2});
  }
  return true;
}

}  // namespace rths::test
