// SPDX-License-Identifier: Apache-2.0
//
// Vendor's GT calls: receiving interrupts. Each caller reads the card's queue with a cursor of his
// own, so all of them see all interrupts.

#include <algorithm>
#include <ctime>

#include "gt_unit.hpp"

using namespace rths::scramnet;

namespace {

constexpr uint32 kFresh = 0xFFFF'FFFF;         // a cursor that has not been used yet
constexpr uint32 kLastSequence = 0x0FFF'FFFF;  // cursors and sequence numbers wrap after it
constexpr std::uint64_t kKept = kGtQueueEntries - 1;
constexpr std::int64_t kLongestSleepNs = 100'000'000;

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

// The place that a cursor means: the latest one, not after the tail, that ends in its digits.
std::uint64_t place_of(uint32 cursor, std::uint64_t tail) {
  return tail - ((tail - cursor) & kLastSequence);
}

/// What one look at the queue brought.
struct Look {
  uint32 count = 0;
  bool missed = false;
};

Look take(const GtCard& card, std::uint64_t& place, scgtInterrupt* into, uint32 most) {
  Look look;
  for (std::uint64_t tail = card.tail.load(); look.count < most && place < tail;) {
    const std::uint64_t oldest = tail > kKept ? tail - kKept : 0;
    if (place < oldest) {
      look.missed = true;
      place = oldest;
    }
    GtInterrupt found;
    if (!read(card, place, found)) {  // overtaken while reading: start again at what is left
      tail = card.tail.load();
      place = std::max(place + 1, tail > kKept ? tail - kKept : 0);
      look.missed = true;
      continue;
    }
    into[look.count++] = {found.type, found.source, found.id, found.value,
                          static_cast<uint32>(place & kLastSequence)};
    ++place;
  }
  return look;
}

}  // namespace

extern "C" uint32 scgtGetInterrupt(scgtHandle* handle, scgtIntrHandle* cursor,
                                   const scgtInterrupt* interrupts, uint32 count, uint32 timeout_ms,
                                   uint32* returned) {
  GtUnit* unit = unit_of(handle);
  if (unit == nullptr || cursor == nullptr || interrupts == nullptr || returned == nullptr)
    return SCGT_BAD_PARAMETER;
  if (*cursor > kLastSequence && *cursor != kFresh) return SCGT_BAD_PARAMETER;
  GtCard& card = unit->card();
  const std::uint64_t now = card.tail.load();
  std::uint64_t place = *cursor == kFresh ? now : place_of(*cursor, now);
  const std::int64_t deadline = now_ns() + std::int64_t{timeout_ms} * 1'000'000;
  Look look;
  for (;;) {
    const std::uint32_t arrivals = card.arrivals.load();
    // The vendor's header calls the buffer const and fills it all the same.
    look = take(card, place, const_cast<scgtInterrupt*>(interrupts), count);
    const std::int64_t left = deadline - now_ns();
    if (look.count != 0 || look.missed || left <= 0) break;
    sleep_on(card, arrivals, std::min(left, kLongestSleepNs));
  }
  *cursor = static_cast<uint32>(place & kLastSequence);
  *returned = look.count;
  if (look.missed) card.counts[kMissed].fetch_add(1);
  if (look.missed) return SCGT_MISSED_INTERRUPTS;
  return look.count != 0 ? SCGT_SUCCESS : SCGT_TIMEOUT;
}
