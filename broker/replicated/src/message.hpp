// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <rths/replicated/ring.hpp>

namespace rths::replicated {

enum class Content : std::uint8_t { Data, Unicast, Broadcast };

/// A message on the ring. Its head is at one node at a time; while it is open, its node may still
/// add longwords behind the head.
struct Message {
  std::uint64_t number = 0;  ///< from 1; a repetition has the number of its first sending
  std::uint32_t origin = 0;  ///< position of the sending node
  std::uint32_t source = 0;  ///< node id in the message
  std::uint32_t address =
      0;  ///< of the first longword on the ring [B]; of an interrupt: its number
  std::uint32_t start_age = 0, age = 0;
  std::uint8_t enables = 0xF;  ///< bytes of the longword that count
  Content content = Content::Data;
  bool interrupt = false, repeated = false;
  bool damaged = false;  ///< behind the fibre that damaged it
  bool open = false;
  bool looped = false;   ///< inside its own card only
  bool on_ring = false;  ///< its head still travels
  std::vector<std::uint32_t> longwords;

  Time sent{0};                 ///< its first bit left its node
  Time arrival{0};              ///< of the first bit at the node of the head
  Time ready{0};                ///< the head could leave that node
  std::uint32_t receivers = 0;  ///< receptions that are not complete
  std::uint32_t next = 0;       ///< behind it in the insertion register
};

inline constexpr std::uint32_t kNone = 0xFFFF'FFFF;

/// Messages by index, reused: no allocation once as many exist as are on the ring at a time.
class Messages {
 public:
  [[nodiscard]] Message& operator[](std::uint32_t index) { return all_[index]; }
  [[nodiscard]] std::uint32_t take() {
    ++in_use_;
    if (free_.empty()) {
      all_.emplace_back();
      free_.reserve(all_.capacity());
      return static_cast<std::uint32_t>(all_.size() - 1);
    }
    const std::uint32_t index = free_.back();
    free_.pop_back();
    return index;
  }
  void give_back(std::uint32_t index) {
    --in_use_;
    free_.push_back(index);
  }
  [[nodiscard]] std::uint32_t in_use() const { return in_use_; }

 private:
  std::vector<Message> all_;
  std::vector<std::uint32_t> free_;
  std::uint32_t in_use_ = 0;
};

}  // namespace rths::replicated
