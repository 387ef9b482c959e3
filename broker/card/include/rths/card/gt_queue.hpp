// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <rths/card/card.hpp>

namespace rths::scramnet {

struct QueuedInterrupt {
  std::uint32_t type = 0, source = 0, id = 0, value = 0;
};

/// Interrupts that a queue keeps for its readers.
inline constexpr std::uint64_t kKeptInterrupts = kGtQueueEntries - 1;

/// Puts an interrupt into a card's queue and wakes its sleeping readers. Any number of processes
/// may call; the entry of a process that dies meanwhile is skipped.
/// @param members  of the ring
/// @returns false if another writer blocked the queue for too long, about 10 ms
[[nodiscard]] bool push(GtCard& card, const QueuedInterrupt& interrupt, broker::Claim self,
                        broker::Members members);

/// Reads the interrupt at a position before the tail.
/// @returns false if it has been overwritten
[[nodiscard]] bool read(const GtCard& card, std::uint64_t position, QueuedInterrupt& interrupt);

/// Sleeps until an interrupt arrives after `arrivals` was read, or the time has passed.
void sleep_on(GtCard& card, std::uint32_t arrivals, std::int64_t nanoseconds);

}  // namespace rths::scramnet
