// SPDX-License-Identifier: Apache-2.0
//
// Vendor's GT calls: receiving interrupts. Each caller reads the card's queue with its own cursor,
// so every caller sees all interrupts.

#include <algorithm>
#include <ctime>

#include <rths/card/monotonic_time.hpp>

#include "gt_unit.hpp"

using namespace rths::scramnet;

namespace {

constexpr uint32 kFresh = 0xFFFF'FFFF;         // a cursor that has not been used yet
constexpr uint32 kLastSequence = 0x0FFF'FFFF;  // cursors and sequence numbers wrap after it
constexpr std::int64_t kLongestSleepNs = 100'000'000;

// The position of a cursor: the latest one, not after the tail, with the cursor's lower 28 bits.
std::uint64_t position_of(uint32 cursor, std::uint64_t tail) {
  return tail - ((tail - cursor) & kLastSequence);
}

/// Result of reading the queue once.
struct Batch {
  uint32 count = 0;
  bool missed = false;
};

Batch collect(const GtCard& card, std::uint64_t& position, scgtInterrupt* into, uint32 most) {
  Batch batch;
  for (std::uint64_t tail = card.tail.load(); batch.count < most && position < tail;) {
    const std::uint64_t oldest = tail > kKeptInterrupts ? tail - kKeptInterrupts : 0;
    if (position < oldest) {
      batch.missed = true;
      position = oldest;
    }
    QueuedInterrupt found;
    if (!read(card, position, found)) {  // overwritten while reading: skip to the oldest entry
      tail = card.tail.load();
      position = std::max(position + 1, tail > kKeptInterrupts ? tail - kKeptInterrupts : 0);
      batch.missed = true;
      continue;
    }
    into[batch.count++] = {found.type, found.source, found.id, found.value,
                           static_cast<uint32>(position & kLastSequence)};
    ++position;
  }
  return batch;
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
  std::uint64_t position = *cursor == kFresh ? now : position_of(*cursor, now);
  const std::int64_t deadline = now_ns() + std::int64_t{timeout_ms} * 1'000'000;
  Batch batch;
  for (;;) {
    const std::uint32_t arrivals = card.arrivals.load();
    // The vendor's header declares the buffer const although the call fills it.
    batch = collect(card, position, const_cast<scgtInterrupt*>(interrupts), count);
    const std::int64_t left = deadline - now_ns();
    if (batch.count != 0 || batch.missed || left <= 0) break;
    sleep_on(card, arrivals, std::min(left, kLongestSleepNs));
  }
  *cursor = static_cast<uint32>(position & kLastSequence);
  *returned = batch.count;
  if (batch.missed) card.counts[kMissed].fetch_add(1);
  if (batch.missed) return SCGT_MISSED_INTERRUPTS;
  return batch.count != 0 ? SCGT_SUCCESS : SCGT_TIMEOUT;
}
