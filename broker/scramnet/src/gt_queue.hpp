// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "card.hpp"

namespace rths::scramnet {

struct GtInterrupt {
  std::uint32_t type = 0, source = 0, id = 0, value = 0;
};

/// Puts an interrupt into a card's queue and wakes whoever sleeps on it. Any number of processes
/// may; one that dies doing so is passed over.
/// @returns false if a living writer held the queue for too long, some 10 ms
[[nodiscard]] bool push(GtCard& card, const GtInterrupt& interrupt, broker::Claim self);

/// The interrupt at a place of the queue that has been written.
/// @returns false if it has been overwritten since
[[nodiscard]] bool read(const GtCard& card, std::uint64_t place, GtInterrupt& interrupt);

/// Sleeps until something arrives after `arrivals` was read, or the time has passed.
void sleep_on(GtCard& card, std::uint32_t arrivals, std::int64_t nanoseconds);

}  // namespace rths::scramnet
