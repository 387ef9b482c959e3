// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>

#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

namespace rths::broker {

// The shared-memory object of a ring, one per ring, named "/rths.<ring>":
//
//   0                    Header                 256 B
//   kSlotsAt             Slot × kMaxSlots       128 B each: who is on the ring
//   groups_at            Group × group_count     64 B each: sequence words of the tear groups
//   map_text_at          canonical map, TOML    map_text_bytes
//   memory_at            the ring's words       memory_bytes, on a page of its own
//   journals_at          0 in this version: the place of the writers' journals
//   cards_at             room for card_count cards, card_bytes each: see card_room.hpp
//
// The cards are at the very end and outside the mapping that every node makes, since nodes lock
// their memory: who needs a card maps that card. Their room is sparse until a card is used.
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
  std::uint64_t map_text_at, map_text_bytes;
  std::uint64_t memory_at, memory_bytes;
  std::uint64_t journals_at;
  std::uint64_t cards_at, card_bytes, card_count;  ///< all 0 if the ring has no room for cards
  std::uint64_t cards_in_use;                      ///< bit n: card n has its room and its registers
};

struct alignas(128) Slot {
  std::uint64_t claim;  ///< the process that holds it, 0 if free; taken by compare-exchange
  std::uint32_t node;   ///< node id, kObserver, or kNotYet between claim and join
  std::uint32_t pad;
  std::uint64_t beats;
};
inline constexpr std::uint32_t kNotYet = 0xFFFF'FFFF;

struct alignas(64) Group {
  std::uint32_t sequence;  ///< odd while a writer is in the middle
  std::uint32_t base, longwords;
};

static_assert(std::is_trivially_copyable_v<Header> && sizeof(Header) == 256);
static_assert(std::is_trivially_copyable_v<Slot> && sizeof(Slot) == 128);
static_assert(std::is_trivially_copyable_v<Group> && sizeof(Group) == 64);

/// A ring that another version of this program or another user may be using.
class ForeignRing : public Error {
 public:
  using Error::Error;
};

/// The bytes of a ring, wherever they come from, and where its parts lie in them.
class Segment {
 public:
  /// Shared memory under a name, filled from the map, with the creator in slot 0.
  /// @throws Error if the name is taken or there is no room; then nothing is left behind
  static std::unique_ptr<Segment> create_shared(const std::string& name, const memmap::Map& map);
  /// @param patience  for a creator that is still at work
  /// @throws ForeignRing if it may not be opened or is of another layout version; Error if it is no
  ///         ring or damaged
  static std::unique_ptr<Segment> attach_shared(const std::string& name,
                                                std::chrono::milliseconds patience);
  static std::unique_ptr<Segment> create_in_process(const memmap::Map& map);

  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;
  ~Segment();

  [[nodiscard]] Header& header() { return *reinterpret_cast<Header*>(base_); }
  [[nodiscard]] Slot* slots() { return at<Slot>(sizeof(Header)); }
  [[nodiscard]] Group* groups() { return at<Group>(header().groups_at); }
  [[nodiscard]] std::uint32_t* words() { return at<std::uint32_t>(header().memory_at); }
  /// The map that the ring was made from. @throws Error if the two do not fit each other
  [[nodiscard]] memmap::Map map();

 private:
  struct Memory;
  Segment(std::unique_ptr<Memory> memory, bool created);
  template <class T>
  [[nodiscard]] T* at(std::uint64_t offset) {
    return reinterpret_cast<T*>(base_ + offset);
  }
  std::unique_ptr<Memory> memory_;
  std::byte* base_;
  bool created_;  ///< here: the creator's slot is free again when this object goes
};

/// Name of the shared-memory object of a ring.
[[nodiscard]] std::string object_name(const std::string& ring);

}  // namespace rths::broker
