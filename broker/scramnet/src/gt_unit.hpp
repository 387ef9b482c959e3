// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "card_session.hpp"

#include <scgtapi.h>

#include <rths/card/gt_queue.hpp>
#include <rths/card/gt_registers.hpp>

namespace rths::scramnet {

inline constexpr uint32 kBroadcasts = 32;  ///< broadcast interrupts of a GT ring
inline constexpr uint32 kNodes = 256;      ///< node ids of a GT ring

/// The GT card of this process with a unit number.
class GtUnit {
 public:
  /// @throws Error
  explicit GtUnit(std::uint32_t unit);

  [[nodiscard]] GtCard& card() const { return session_.card().gt; }
  [[nodiscard]] CardSession& session() { return session_; }
  [[nodiscard]] GtRing ring() const;
  [[nodiscard]] std::uint32_t memory_bytes() const {
    return static_cast<std::uint32_t>(session_.memory_bytes());
  }
  /// The driver's mapping of the memory, for DMA; independent of the client's.
  [[nodiscard]] std::byte* memory() const { return memory_; }
  /// Sends an interrupt to every card that accepts it. @returns false if a card's queue was blocked
  [[nodiscard]] bool send(const scgtInterrupt& interrupt);

 private:
  CardSession session_;
  std::byte* memory_;
};

/// The card of a handle; null if the handle is null or was never opened.
[[nodiscard]] GtUnit* unit_of(const scgtHandle* handle) noexcept;
/// The card of a unit; takes one if needed. On failure prints the reason and returns null.
[[nodiscard]] GtUnit* take_unit(std::uint32_t unit) noexcept;

}  // namespace rths::scramnet
