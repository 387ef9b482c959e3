// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

#include "journal.hpp"
#include "layout.hpp"

namespace rths::broker {

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
  static std::unique_ptr<Segment> create_shared(const std::string& name, const memmap::Map& map,
                                                std::uint32_t journal_bits);
  /// @param patience  for a creator that is still at work
  /// @throws ForeignRing if it may not be opened or is of another layout version; Error if it is no
  ///         ring or damaged
  static std::unique_ptr<Segment> attach_shared(const std::string& name,
                                                std::chrono::milliseconds patience);
  static std::unique_ptr<Segment> create_in_process(const memmap::Map& map,
                                                    std::uint32_t journal_bits);

  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;
  ~Segment();

  [[nodiscard]] Header& header() { return *reinterpret_cast<Header*>(base_); }
  [[nodiscard]] std::span<Slot, kMaxSlots> slots() {
    return std::span<Slot, kMaxSlots>{at<Slot>(sizeof(Header)), kMaxSlots};
  }
  /// Takes the pages that every process maps into this one's table, for which there is room. @setup
  void populate();
  /// The slot of a node that is, or was, on the ring; null if there is none.   @realtime
  [[nodiscard]] Slot* slot_of(NodeId node) noexcept;
  [[nodiscard]] Group* groups() { return at<Group>(header().groups_at); }
  [[nodiscard]] std::uint32_t* words() { return at<std::uint32_t>(header().memory_at); }
  [[nodiscard]] Wake& wake() { return *at<Wake>(kWakeAt); }
  [[nodiscard]] std::uint32_t* record(const Group& group) {
    return at<std::uint32_t>(header().records_at + group.record_at);
  }
  /// A node's journal, by the node's place in the map. Takes room for it and maps it when it is
  /// first asked for. @throws Error if there is no room   @setup
  [[nodiscard]] JournalPlace journal(std::uint32_t index);
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
  bool populated_ = false;
  bool created_;  ///< here: the creator's slot is free again when this object goes
};

/// Name of the shared-memory object of a ring.
[[nodiscard]] std::string object_name(const std::string& ring);

}  // namespace rths::broker
