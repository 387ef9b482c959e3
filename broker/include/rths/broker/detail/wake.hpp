// SPDX-License-Identifier: Apache-2.0
//
// Wakes processes that sleep until the next write. A writer needs one load of a cache line that
// does not change while no process sleeps. Internal: see journal_writer.hpp.
#pragma once

#include <atomic>
#include <cstdint>

namespace rths::broker {

/// Shared by all processes of a ring. Two cache lines: setting a bit does not disturb the futex
/// word.
struct alignas(64) Wake {
  std::uint32_t calls = 0;                 ///< futex word: number of wake-ups
  alignas(64) std::uint32_t sleepers = 0;  ///< one bit per slot that sleeps or is about to
};
static_assert(sizeof(Wake) == 128);

/// Includes this process in the fences of sleepers. Called once, before the first write.
void register_as_writer();

/// The slow path of `wake_sleepers`.
void wake_all(Wake& wake, std::uint32_t spared) noexcept;

/// Wakes all sleepers; called after each write.
/// @param spared  bits of the slots that need not wake
inline void wake_sleepers(Wake& wake, std::uint32_t spared = 0) noexcept {
  const std::uint32_t sleepers = std::atomic_ref{wake.sleepers}.load(std::memory_order_relaxed);
  if ((sleepers & ~spared) != 0) wake_all(wake, spared);
}

}  // namespace rths::broker
