// SPDX-License-Identifier: Apache-2.0
//
// Waking those who sleep until somebody writes. A writer pays one load of a line that nobody
// touches while nobody sleeps. Not for use: see journal_writer.hpp.
#pragma once

#include <atomic>
#include <cstdint>

namespace rths::broker {

/// Shared by all processes of a ring: two lines, so that sleepers do not disturb each other's word.
struct alignas(64) Wake {
  std::uint32_t calls = 0;                 ///< futex word: counts wake-ups
  alignas(64) std::uint32_t sleepers = 0;  ///< slots that sleep, or are about to, a bit each
};
static_assert(sizeof(Wake) == 128);

/// The slow part of `wake_sleepers`.
void wake_all(Wake& wake) noexcept;

/// After a write.
inline void wake_sleepers(Wake& wake) noexcept {
  if (std::atomic_ref{wake.sleepers}.load(std::memory_order_relaxed) != 0) wake_all(wake);
}

}  // namespace rths::broker
