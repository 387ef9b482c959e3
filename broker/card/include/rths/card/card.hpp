// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include <rths/broker/detail/card_layout.hpp>
#include <rths/broker/detail/process.hpp>

namespace rths::scramnet {

// The state of a card in the ring's object. It outlives every process that uses it. It consists of
// atomic words: there is no lock that a dead process could hold.

using Word = std::atomic<std::uint32_t>;
using SharedClaim = std::atomic<broker::Claim>;
static_assert(Word::is_always_lock_free && SharedClaim::is_always_lock_free);

inline constexpr std::uint32_t kFifoEntries = 1024;
inline constexpr std::uint32_t kMaxRegistrations = 32;

/// Addresses of the longwords whose interrupts arrived, oldest first. One process at a time adds
/// (see Scanner); any number of processes take.
struct InterruptFifo {
  Word head, tail;  ///< numbers of entries taken and added so far
  std::array<Word, kFifoEntries> address;
};

/// Registers of a SCRAMNet+ card.
struct PlusCard {
  std::array<Word, 16> csr;  ///< 16 bits each
  Word latched;              ///< bits of CSR1 that reading clears
  Word armed;                ///< CSR1 bit 14
  Word receive_id, transmit_age, timeout;
  Word counter;  ///< value of CSR13 at `counter_since_ns`
  std::atomic<std::int64_t> counter_since_ns;
  Word acr_changes;                                       ///< number of writes to the ACR
  Word host_interrupts;                                   ///< delivered so far
  SharedClaim scanner;                                    ///< process that is comparing words now
  std::array<SharedClaim, kMaxRegistrations> registered;  ///< processes that get SIGUSR1
  InterruptFifo fifo;
};

inline constexpr std::uint32_t kGtRegisters = 64;
inline constexpr std::uint32_t kGtQueueEntries = 1024;

/// One interrupt that a GT card received. `stamp` is its position in the queue plus one, 0 while it
/// is being written; `writer` is the process that has reserved the entry.
struct GtEntry {
  std::atomic<std::uint64_t> stamp;
  SharedClaim writer;
  Word type, source, id, value;
};

struct GtCard {
  std::array<Word, kGtRegisters> cr;  ///< control registers, by offset / 4
  std::array<Word, 16> own;           ///< states that are in no documented register
  std::array<Word, 8> counts;         ///< statistics
  std::atomic<std::int64_t> timer_since_ns;
  Word arrivals;  ///< changes with each interrupt; sleeping readers wait on it
  Word sleepers;
  std::atomic<std::uint64_t> tail;
  std::array<GtEntry, kGtQueueEntries> queue;
};

inline constexpr std::uint32_t kTrapEntries = 2048;
inline constexpr std::uint32_t kLongestTrap = 17;  ///< entries of a store of 64 bytes

/// A store to one longword, of 1, 2 or 4 bytes. `stamp` says how far the entry is: see
/// trap_queue.hpp.
struct TrapEntry {
  Word stamp;
  Word address;  ///< address on the ring [B]
  Word form;     ///< width [B], and kTrapInMemory if the memory has the value; 0: no store
  Word value;
};
inline constexpr std::uint32_t kTrapInMemory = 0x100;

/// Stores that traps have taken, oldest first. Hosts add; the thread that carries messages takes.
struct TrapQueue {
  Word reserved, taken;  ///< numbers of entries so far
  std::array<TrapEntry, kTrapEntries> entries;
};

/// Of a card whose stores are carried by messages; broker/replicated writes it at each scan, and
/// clears what its host counts.
struct Carried {
  Word active;                  ///< 1: no process compares words, and none shares this memory
  Word plain_host;              ///< 1: its host stores through a pointer; set before it joins
  Word scans;                   ///< so far
  Word live_status;             ///< bits of CSR1 whose cause persists
  Word ring_nodes;              ///< as the last own return showed
  Word transmit_resets;         ///< of the transmit FIFO since the last scan; counted by its host
  Word counter_writes;          ///< of CSR13 since the last scan; counted by its host
  Word transmit_fifo;           ///< entries
  Word sent, stored, rejected;  ///< messages so far
  Word same_id;                 ///< messages of other nodes with this card's id so far
  Word has_traps;               ///< 1: its host traps stores
  TrapQueue traps;
};

struct Card {
  Word ready;          ///< kCardReady: powered up
  Word key;            ///< kAnonymous, or kNamed | node id
  SharedClaim holder;  ///< process that has taken the card
  Word is_copy;        ///< 1: a gateway's, of the card of a node on another host
  PlusCard plus;
  GtCard gt;
  Carried carried;
};
static_assert(sizeof(Card) <= broker::kCardRegisterBytes);

inline constexpr std::uint32_t kCardReady = 1;
inline constexpr std::uint32_t kAnonymous = 1;
inline constexpr std::uint32_t kNamed = 0x1'0000;

/// Default node id: 10, as in the vendor's library, plus the card's index, so that programs that
/// set no id do not share one.
[[nodiscard]] constexpr std::uint32_t default_id(std::uint32_t index) noexcept {
  return 10 + index;
}

/// Sets the registers to their values after power-up.
void power_up(Card& card, std::uint32_t index);

}  // namespace rths::scramnet
