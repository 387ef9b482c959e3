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

/// A ring of another layout version or of another user, which may be in use.
class ForeignRing : public Error {
 public:
  using Error::Error;
};

/// The memory of a ring, shared or private, and the addresses of its sections.
class Segment {
 public:
  /// Creates named shared memory, initialised from the map, with the creator in slot 0.
  /// @throws Error if the name is taken or memory is short; leaves no object then
  static std::unique_ptr<Segment> create_shared(const std::string& name, const memmap::Map& map,
                                                std::uint32_t journal_bits);
  /// @param timeout  of the wait for a creator that is not finished
  /// @throws ForeignRing if the object may not be opened or its layout version differs; Error if it
  ///         is not a ring or is damaged
  static std::unique_ptr<Segment> attach_shared(const std::string& name,
                                                std::chrono::milliseconds timeout);
  static std::unique_ptr<Segment> create_in_process(const memmap::Map& map,
                                                    std::uint32_t journal_bits);

  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;
  ~Segment();

  [[nodiscard]] Header& header() { return *reinterpret_cast<Header*>(base_); }
  [[nodiscard]] std::span<Slot, kMaxSlots> slots() {
    return std::span<Slot, kMaxSlots>{at<Slot>(sizeof(Header)), kMaxSlots};
  }
  /// Maps all reserved pages of the common section into this process's page table. @setup
  void populate();
  /// The slot of a node that is on the ring or vanished from it; null if none.   @realtime
  [[nodiscard]] Slot* slot_of(NodeId node) noexcept;
  [[nodiscard]] Group* groups() { return at<Group>(header().groups_at); }
  [[nodiscard]] std::uint32_t* words() { return at<std::uint32_t>(header().memory_at); }
  [[nodiscard]] Wake& wake() { return *at<Wake>(kWakeAt); }
  [[nodiscard]] std::uint32_t* record(const Group& group) {
    return at<std::uint32_t>(header().records_at + group.record_at);
  }
  /// The journal of a node, by the node's index in the map. The first call reserves space for it
  /// and maps it. @throws Error if memory is short   @setup
  [[nodiscard]] JournalView journal(std::uint32_t index);
  /// The map of the ring. @throws Error if it does not match the ring's header
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
  bool created_;  ///< by this object: the destructor frees the creator's slot
};

/// Name of the shared-memory object of a ring.
[[nodiscard]] std::string object_name(const std::string& ring);

}  // namespace rths::broker
