// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include <rths/memmap/map.hpp>

namespace rths::broker {

// The shared-memory object of a ring, one per ring, named "/rths.<ring>":
//
//   0                    Header                 256 B
//   kSlotsAt             Slot × kMaxSlots       128 B each: processes on the ring
//   kWakeAt              Wake                   128 B: processes that sleep until the next write
//   groups_at            Group × group_count     128 B each: the tear groups
//   records_at           records of the groups  see record.hpp
//   map_text_at          canonical map, TOML    map_text_bytes
//   memory_at            the ring's words       memory_bytes, on a page of its own
//   journals_at          a journal per node     journal_bytes each, on pages of their own
//
//   cards_at             kMaxSlots cards        of the vendor's interface: see card_layout.hpp
//
// Nodes lock their memory, so journals and cards are outside the mapping that every node has. Space
// for a journal is reserved when its node first joins, for a card when it is first used; a process
// maps those that it needs.
//
// kLayoutVersion is incremented when a program built before would misread any of this.
inline constexpr std::uint64_t kMagic = 0x474E'4952'5348'5452;  // "RTHSRING" in memory
inline constexpr std::uint32_t kLayoutVersion = 4;
inline constexpr std::uint32_t kMaxSlots = 32;
inline constexpr std::size_t kPageBytes = 4096;
inline constexpr std::uint64_t kMostMapText = 4U << 20U;     ///< [B]
inline constexpr std::uint64_t kMostJournals = 256U << 20U;  ///< of all nodes together [B]
inline constexpr std::uint32_t kObserver = 0xFFFF;           ///< node id of a slot that only reads
inline constexpr std::uint32_t kCreator = 0xFFFF'FFFE;       ///< node id of the creator's slot

struct alignas(256) Header {
  std::uint64_t magic;
  std::uint32_t layout_version;
  std::uint32_t unused;
  std::uint64_t creator;  ///< claim of the creating process; see process.hpp
  std::uint64_t map_hash;
  std::uint64_t groups_at, group_count;
  std::uint64_t records_at, records_bytes;
  std::uint64_t map_text_at, map_text_bytes;
  std::uint64_t memory_at, memory_bytes;
  std::uint64_t journals_at, journal_bits, journal_count;
  std::uint64_t cards_at, card_bytes, card_count;
  std::uint64_t cards_in_use;   ///< bit n: card n has its space and its registers
  std::uint64_t looks;          ///< that `rths watch` has completed
  std::uint64_t is_replicated;  ///< 1: each node has an image; see broker/replicated
  std::uint64_t fault;          ///< that a process asks the cards of these images for; 0: none
  std::uint64_t watcher;        ///< claim of the process that watches the ring; 0: none

  bool operator==(const Header&) const = default;
};

struct alignas(128) Slot {
  std::uint64_t claim;  ///< process that holds the slot, 0 if free; set by compare-exchange
  std::uint32_t node;   ///< node id, kObserver, or kNotYet between claim and join
  std::uint32_t plain;  ///< 1: stores through a plain pointer, without a journal
  std::uint64_t beats;
  std::uint64_t plain_joins;  ///< high half: joins as a plain node so far; low: the last one's id
};
inline constexpr std::uint32_t kNotYet = 0xFFFF'FFFF;
inline constexpr std::size_t kWakeAt = 256 + kMaxSlots * 128;

struct alignas(128) Group {
  std::uint32_t base, longwords;
  std::uint32_t journal;     ///< index of its node's journal
  std::uint32_t record_at;   ///< from the header's records_at [B]
  std::uint32_t journalled;  ///< count of the record's last write in the journal
};

static_assert(std::is_trivially_copyable_v<Header> && sizeof(Header) == 256);
static_assert(std::is_trivially_copyable_v<Slot> && sizeof(Slot) == 128);
static_assert(std::is_trivially_copyable_v<Group> && sizeof(Group) == 128);

/// Index of a node in the map and of its journal.
[[nodiscard]] std::uint32_t node_index(const memmap::Map& map, NodeId node);

/// The layout of a ring with this map: a header with all members but `creator`.
/// @throws Error if the text of the map or the journals are too large
[[nodiscard]] Header plan_layout(const memmap::Map& map, const std::string& map_text,
                                 std::uint32_t journal_bits);
/// Bytes of the whole object, and of the common section that every process maps.
[[nodiscard]] std::uint64_t total_bytes(const Header& header);
[[nodiscard]] std::uint64_t common_bytes(const Header& header);
/// Begin of a journal in the object [B].
[[nodiscard]] std::uint64_t journal_at(const Header& header, std::uint32_t index);
/// True if both headers have the same layout and map.
[[nodiscard]] bool is_same_layout(const Header& a, const Header& b);
/// The table of tear groups of a map.
[[nodiscard]] std::vector<Group> plan_groups(const memmap::Map& map);
/// Initialises the common section.
void fill(std::byte* base, const Header& header, const memmap::Map& map,
          const std::string& map_text);

}  // namespace rths::broker
