// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "card_layout.hpp"
#include "process.hpp"

namespace rths::scramnet {

// What a card is, in the ring's object. It outlives every process that uses it. All of it is
// atomic words: there is no lock that a process could die with.

using Word = std::atomic<std::uint32_t>;
using SharedClaim = std::atomic<broker::Claim>;
static_assert(Word::is_always_lock_free && SharedClaim::is_always_lock_free);

inline constexpr std::uint32_t kFifoEntries = 1024;
inline constexpr std::uint32_t kMaxRegistrations = 32;

/// Addresses of the longwords whose interrupts arrived, oldest first. One process at a time adds
/// (see Scanner); any number take.
struct InterruptFifo {
  Word head, tail;  ///< counted on for ever; taken and added so far
  std::array<Word, kFifoEntries> address;
};

/// Registers of a SCRAMNet+ card that are not simply what was last written.
struct PlusCard {
  std::array<Word, 16> csr;  ///< 16 bits each
  Word latched;              ///< bits of CSR1 that reading clears
  Word armed;                ///< CSR1 bit 14
  Word receive_id, transmit_age, timeout;
  Word counter;  ///< CSR13 as it was at `counter_since_ns`
  std::atomic<std::int64_t> counter_since_ns;
  Word acr_changes;                                       ///< how often the ACR was written
  Word host_interrupts;                                   ///< delivered so far
  SharedClaim scanner;                                    ///< who is comparing words now
  std::array<SharedClaim, kMaxRegistrations> registered;  ///< who gets SIGUSR1
  InterruptFifo fifo;
};

inline constexpr std::uint32_t kGtRegisters = 64;
inline constexpr std::uint32_t kGtQueueEntries = 1024;

/// One interrupt that a GT card received. `stamp` is its place in the queue plus one, 0 while it
/// is being written; `writer` is who has reserved the entry.
struct GtEntry {
  std::atomic<std::uint64_t> stamp;
  SharedClaim writer;
  Word type, source, id, value;
};

struct GtCard {
  std::array<Word, kGtRegisters> cr;  ///< control registers, by offset / 4
  std::array<Word, 16> own;           ///< states that no documented register holds
  std::array<Word, 8> counts;         ///< statistics
  std::atomic<std::int64_t> timer_since_ns;
  Word arrivals;  ///< changes with each interrupt: what a sleeping reader waits on
  Word sleepers;
  std::atomic<std::uint64_t> tail;
  std::array<GtEntry, kGtQueueEntries> queue;
};

struct Card {
  Word ready;          ///< kCardReady: powered up
  Word key;            ///< which card it is: kAnonymous, or kNamed | node id
  SharedClaim holder;  ///< the process it was taken by
  PlusCard plus;
  GtCard gt;
};
static_assert(sizeof(Card) <= broker::kCardRegisterBytes);

inline constexpr std::uint32_t kCardReady = 1;
inline constexpr std::uint32_t kAnonymous = 1;
inline constexpr std::uint32_t kNamed = 0x1'0000;

/// What the vendor's library gives a card unless told otherwise, and a card more for each card of
/// the ring, so that programs that never set an id do not share one.
[[nodiscard]] constexpr std::uint32_t default_id(std::uint32_t index) noexcept {
  return 10 + index;
}

/// The registers as they are when a card gets power.
void power_up(Card& card, std::uint32_t index);

}  // namespace rths::scramnet
