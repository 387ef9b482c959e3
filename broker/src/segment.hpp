// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <rths/broker/detail/layout.hpp>
#include <rths/broker/detail/process.hpp>
#include <rths/broker/detail/shared_object.hpp>
#include <rths/broker/detail/wake.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

#include "journal.hpp"

namespace rths::broker {

/// A ring of another layout version or of another user, which may be in use.
class ForeignRing : public Error {
 public:
  using Error::Error;
};

/// A tear group: its checked entry in the table, and the addresses of its parts.
struct GroupView {
  std::uint32_t base = 0, longwords = 0;
  std::uint32_t journal = 0;  ///< index of its node's journal
  std::uint32_t* record = nullptr;
  std::uint32_t* words = nullptr;
  std::uint32_t* journalled = nullptr;  ///< count of the record's last write in the journal
};

/// The memory of a ring, shared or private, and the addresses of its sections.
///
/// Any program may have made a shared object, and may change it at any time. So its header, map and
/// groups are checked against each other and against its size before it is mapped, and the checked
/// copies are used from then on.
class Segment {
 public:
  /// Creates named shared memory, initialised from the map, with the creator in slot 0.
  /// @throws Error if the name is taken or memory is short; leaves no object then
  static std::unique_ptr<Segment> create_shared(const std::string& name, const memmap::Map& map,
                                                std::uint32_t journal_bits);
  /// @throws ForeignRing if the object may not be opened or its layout version differs; Error if it
  ///         is not a ring, or its header, map, groups or size contradict each other
  static std::unique_ptr<Segment> attach_shared(const std::string& name,
                                                ObjectAccess access = ObjectAccess::ReadWrite);
  static std::unique_ptr<Segment> create_in_process(const memmap::Map& map,
                                                    std::uint32_t journal_bits);

  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;
  ~Segment();

  /// The header in the memory; other processes may change it.
  [[nodiscard]] Header& header() { return *reinterpret_cast<Header*>(base_); }
  /// The checked header.
  [[nodiscard]] const Header& layout() const { return layout_; }
  [[nodiscard]] std::span<Slot, kMaxSlots> slots() {
    return std::span<Slot, kMaxSlots>{at<Slot>(sizeof(Header)), kMaxSlots};
  }
  /// Maps all reserved pages of the common section into this process's page table. @setup
  void populate();
  /// The slot of a node that is on the ring or vanished from it; null if none.   @realtime
  [[nodiscard]] Slot* slot_of(NodeId node) noexcept;
  [[nodiscard]] std::span<const GroupView> groups() const { return groups_; }
  [[nodiscard]] std::uint32_t* words() { return at<std::uint32_t>(layout_.memory_at); }
  [[nodiscard]] Wake& wake() { return *at<Wake>(kWakeAt); }
  /// Shows this process to all others on the ring while the result exists; null for a ring of one
  /// process, and for one that is read only. @throws Error if the ring was removed, or is being
  /// removed   @setup
  [[nodiscard]] std::unique_ptr<Membership> enter() const;
  /// True if a process runs and is on the ring.   @setup
  [[nodiscard]] bool is_member(Claim claim) const;
  /// True if this process can change nothing: any store to the memory would end it.
  [[nodiscard]] bool is_read_only() const;
  /// Of the ring; empty for a ring of one process.
  [[nodiscard]] const std::string& name() const;
  /// True if the ring of this name is this memory, not one that has replaced it.   @setup
  [[nodiscard]] bool has_name() const;
  /// True once a page of the memory was lost, or its header was overwritten.   @realtime
  [[nodiscard]] bool is_lost() const noexcept;
  /// The journal of a node, by the node's index in the map. The first call reserves space for it
  /// and maps it. @throws Error if memory is short   @setup
  [[nodiscard]] JournalView journal(std::uint32_t index);
  [[nodiscard]] const memmap::Map& map() const { return map_; }

 private:
  struct Memory;
  Segment(std::unique_ptr<Memory> memory, const Header& layout, memmap::Map map);
  template <class T>
  [[nodiscard]] T* at(std::uint64_t offset) {
    return reinterpret_cast<T*>(base_ + offset);
  }
  std::unique_ptr<Memory> memory_;
  std::byte* base_;
  Header layout_;
  memmap::Map map_;
  std::vector<GroupView> groups_;
  bool populated_ = false;
  std::unique_ptr<Membership> creator_;  ///< if this object created the ring
};

}  // namespace rths::broker
