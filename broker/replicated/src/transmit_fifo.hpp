// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "message.hpp"

namespace rths::replicated {

/// A store on its way to the ring.
struct FifoEntry {
  std::uint32_t address = 0;  ///< on the ring [B]; of an interrupt: its number
  std::uint32_t value = 0;
  std::uint8_t enables = 0xF;
  Content content = Content::Data;
  bool interrupt = false;
};

/// Bytes of a longword that a store of 1, 2 or 4 bytes covers, as bits.
[[nodiscard]] constexpr std::uint8_t enabled_bytes(std::uint32_t offset, std::uint32_t bytes) {
  return static_cast<std::uint8_t>(((1U << bytes) - 1) << offset % 4);
}

/// The card's transmit FIFO. The vendor's self-test expects its full flag by 1022 entries.
class TransmitFifo {
 public:
  static constexpr std::uint32_t kEntries = 1024, kSevenEighths = 896, kFullFlag = 1022;

  [[nodiscard]] std::uint32_t size() const { return added_ - taken_; }
  [[nodiscard]] bool is_empty() const { return added_ == taken_; }
  [[nodiscard]] bool is_full() const { return size() == kEntries; }
  [[nodiscard]] const FifoEntry& first() const { return entries_[taken_ % kEntries]; }
  void add(const FifoEntry& entry) { entries_[added_++ % kEntries] = entry; }
  FifoEntry take() { return entries_[taken_++ % kEntries]; }
  void clear() { taken_ = added_; }

 private:
  std::array<FifoEntry, kEntries> entries_{};
  std::uint32_t added_ = 0, taken_ = 0;
};

}  // namespace rths::replicated
