// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include <rths/card/card.hpp>
#include <rths/card/registers.hpp>
#include <rths/replicated/ring.hpp>

#include "acr_cells.hpp"
#include "message.hpp"
#include "sparse_bytes.hpp"
#include "transmit_fifo.hpp"

namespace rths::replicated {

/// CSR0 of a node on the ring: inserted, receives, transmits.
inline constexpr std::uint32_t kOnRing = 0x8003;

/// How a node's transmitter and receiver are connected.
enum class Path : std::uint8_t {
  Off,       ///< no power: the ring passes optically
  Monitor,   ///< receives only: the ring passes optically
  Looped,    ///< own messages return inside the card: the ring passes optically
  Inserted,  ///< in the ring
  Breaking   ///< wire loopback of an inserted node: the ring is open
};

/// The message whose bits pass a node's input or output now.
struct CardLine {
  std::uint32_t open = kNone;  ///< message of unknown length; none if the line's end is known
  Time start{0};               ///< of the last message
  Time free{0};                ///< output only: the next message may start; unknown while open
  bool own = false, received = false;  ///< input only: of the open message
};

/// A message of a card with error correction, until it has returned intact.
struct Outstanding {
  bool active = false, repeat = false;
  std::uint32_t attempt = 0;
  Message message;
};

inline constexpr std::uint32_t kGtQueue = 256;  ///< hardware queue of a GT card

/// Interrupts of a GT card, oldest first; a full queue drops the newest.
struct GtQueue {
  std::array<GtInterrupt, kGtQueue> entries{};
  std::uint32_t added = 0, taken = 0;
  [[nodiscard]] std::uint32_t size() const { return added - taken; }
};

struct CardNode {
  explicit CardNode(const NodeSetup& setup, CardType type);

  // Ring.
  Time fibre, extra_delay;
  bool connected = true, bypass_switch, powered = true;
  Path path = Path::Monitor;
  CardLine input, output;
  std::uint32_t waiting_first = kNone, waiting_last = kNone, waiting = 0;  ///< insertion register

  // Transmitter.
  TransmitFifo fifo;
  std::uint32_t own_open = kNone;  ///< own message that may get longer
  Time transmit_at{0};             ///< of the scheduled transmission
  bool transmit_scheduled = false;
  bool yielded = false;  ///< the next own message has already let one message pass
  Outstanding outstanding;
  Time transit_since{0};
  bool transit_armed = false, transit_runs = false;
  Time round_trip{0};  ///< of the last own message that has returned; 0: none

  // Card.
  std::uint32_t id;  ///< after power-up
  SparseBytes memory;
  AcrCells acr;
  std::unique_ptr<scramnet::PlusCard> own_plus;
  scramnet::PlusCard* plus = nullptr;  ///< own, or in `shared`
  scramnet::Card* shared = nullptr;    ///< card in the object of an image
  broker::Members members{-1};         ///< of that image
  std::unique_ptr<scramnet::GtCard> gt;
  std::uint32_t hipro_longword = kNone;  ///< whose bytes are being collected
  std::uint8_t hipro_bytes = 0;
  GtQueue queue;
  CardReport counts;
};

}  // namespace rths::replicated
