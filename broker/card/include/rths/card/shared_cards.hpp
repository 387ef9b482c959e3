// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rths::scramnet {

/// A card of a program on a ring in shared memory, as it was at one instant.
struct SharedCard {
  std::uint32_t index = 0;
  std::string process;                  ///< its process in words; empty: the card is idle
  bool gt = false;                      ///< a GT card, which has no CSRs
  std::uint32_t id = 0;                 ///< node id
  std::array<std::uint32_t, 16> csr{};  ///< without the side effects of reading
  std::uint32_t interrupt_fifo = 0;     ///< entries
  std::uint32_t host_interrupts = 0;    ///< delivered so far

  /// Level and messages so far of a card of a replicated ring.
  struct Carried {
    std::uint32_t transmit_fifo = 0;  ///< entries
    std::uint32_t ring_nodes = 0;     ///< as its last own message showed; 0: none yet
    std::uint32_t sent = 0, stored = 0, rejected = 0;
    std::uint32_t same_id = 0;  ///< messages of other nodes with this card's id
  };
  std::optional<Carried> carried;
};

/// The cards of a ring that are in use.
/// @throws Error if there is no such ring or it cannot be read   @setup
[[nodiscard]] std::vector<SharedCard> cards_of(const std::string& ring);

}  // namespace rths::scramnet
