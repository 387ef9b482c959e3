// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

#include <rths/memmap/map.hpp>

#include "wake.hpp"

namespace rths::broker {

// The shared-memory object of a ring, one per ring, named "/rths.<ring>":
//
//   0                    Header                 256 B
//   kSlotsAt             Slot × kMaxSlots       128 B each: who is on the ring
//   kWakeAt              Wake                   128 B: who sleeps until somebody writes
//   groups_at            Group × group_count     128 B each: the tear groups
//   records_at           their records          see record.hpp
//   map_text_at          canonical map, TOML    map_text_bytes
//   memory_at            the ring's words       memory_bytes, on a page of its own
//   journals_at          a journal per node     journal_bytes each, on pages of their own
//
//   cards_at             room for kMaxSlots cards of the vendor's interface: see card_room.hpp
//
// Journals and cards are outside the mapping that every node makes, since nodes lock their memory.
// Room for a journal is taken when its node first joins, for a card when it is first used, and
// whoever needs one maps it then.
//
// kLayoutVersion is bumped whenever a program built before would read any of this wrongly.
inline constexpr std::uint64_t kMagic = 0x474E'4952'5348'5452;  // "RTHSRING" in memory
inline constexpr std::uint32_t kLayoutVersion = 2;
inline constexpr std::uint32_t kMaxSlots = 32;
inline constexpr std::size_t kPageBytes = 4096;
inline constexpr std::uint32_t kReady = 1;
inline constexpr std::uint32_t kObserver = 0xFFFF;      ///< node id of a slot that only reads
inline constexpr std::uint32_t kCreator = 0xFFFF'FFFE;  ///< and of whoever made the ring

struct alignas(256) Header {
  std::uint64_t magic;
  std::uint32_t layout_version;
  std::uint32_t ready;    ///< kReady, stored last: everything before it can be trusted
  std::uint64_t creator;  ///< claim of the creating process; see process.hpp
  std::uint64_t map_hash;
  std::uint64_t groups_at, group_count;
  std::uint64_t records_at, records_bytes;
  std::uint64_t map_text_at, map_text_bytes;
  std::uint64_t memory_at, memory_bytes;
  std::uint64_t journals_at, journal_bits, journal_count;
  std::uint64_t cards_at, card_bytes, card_count;
  std::uint64_t cards_in_use;  ///< bit n: card n has its room and its registers
};

struct alignas(128) Slot {
  std::uint64_t claim;  ///< the process that holds it, 0 if free; taken by compare-exchange
  std::uint32_t node;   ///< node id, kObserver, or kNotYet between claim and join
  std::uint32_t plain;  ///< 1: stores through a plain pointer, and journals nothing
  std::uint64_t beats;
};
inline constexpr std::uint32_t kNotYet = 0xFFFF'FFFF;
inline constexpr std::size_t kWakeAt = 256 + kMaxSlots * 128;

struct alignas(128) Group {
  std::uint32_t base, longwords;
  std::uint32_t journal;     ///< of its node
  std::uint32_t record_at;   ///< from the header's records_at [B]
  std::uint32_t journalled;  ///< count of the record's last write that its node's journal has
};

static_assert(std::is_trivially_copyable_v<Header> && sizeof(Header) == 256);
static_assert(std::is_trivially_copyable_v<Slot> && sizeof(Slot) == 128);
static_assert(std::is_trivially_copyable_v<Group> && sizeof(Group) == 128);

/// A node's place in the map, which is also that of its journal.
[[nodiscard]] std::uint32_t node_place(const memmap::Map& map, NodeId node);

/// The layout of a ring with this map, with everything but `ready` filled in.
[[nodiscard]] Header plan_layout(const memmap::Map& map, const std::string& map_text,
                                 std::uint32_t journal_bits);
/// Bytes of the whole object, and of the part of it that every process maps.
[[nodiscard]] std::uint64_t total_bytes(const Header& header);
[[nodiscard]] std::uint64_t common_bytes(const Header& header);
/// Where a journal begins in the object.
[[nodiscard]] std::uint64_t journal_at(const Header& header, std::uint32_t index);
/// True if the parts lie one behind the other, as `plan_layout` puts them, and are of sane sizes.
[[nodiscard]] bool parts_are_in_order(const Header& header);
/// Fills the common part; `ready` last, so whoever sees it sees all the rest.
void fill(std::byte* base, const Header& header, const memmap::Map& map,
          const std::string& map_text);

}  // namespace rths::broker
