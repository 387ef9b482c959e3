// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <rths/card/card.hpp>
#include <rths/card/monotonic_time.hpp>

namespace rths::scramnet {

// Control registers of a GT card, by index (byte offset / 4), and the bits that act here.
namespace gt {
inline constexpr std::uint32_t kBoardInfo = 0, kUser = 2, kLinkControl = 4, kLinkStatus = 5,
                               kBroadcastMask = 6, kUnicastMask = 7, kMisc = 8, kTimer = 16,
                               kLatency = 18;
inline constexpr std::uint32_t kNodeIdShift = 8, kTransmit = 1U << 16, kReceive = 1U << 17,
                               kWrap = 1U << 19, kWriteMeLast = 1U << 20, kInterruptSelf = 1U << 21;
/// Of kLinkControl: transmits, receives, retransmits, both lasers are on.
inline constexpr std::uint32_t kLinkAtPowerUp = 0x7'0003;
inline constexpr std::uint32_t kLinkUp = 0x2'0000, kSignal0 = 0x4'0000, kSignal1 = 0x8'0000;
inline constexpr std::uint32_t kSwaps = 0x3;
}  // namespace gt

/// States of a card, and types of interrupt, by their numbers in the vendor's API.
namespace gt_state {
enum : std::uint32_t {
  kNodeId,
  kActiveLink,
  kLinkErrors,
  kWrap,
  kWriteMeLast,
  kUnicastMask,
  kBroadcastMask,
  kInterruptSelf,
  kRingSize,
  kUpstreamNodeId,
  kNetTimer,
  kLatencyTimer,
  kTrafficCount,
  kSpyTrafficCount,
  kSpyNodeId,
  kTransmitEnable,
  kReceiveEnable,
  kRetransmitEnable,
  kLaser0Enable,
  kLaser1Enable,
  kLinkUp,
  kLaser0Signal,
  kLaser1Signal,
  kD64Enable,
  kByteSwapEnable,
  kWordSwapEnable,
  kLinkErrorInterrupt,
  kReadBypassEnable
};
}
namespace gt_interrupt {
enum : std::uint32_t { kUnicast, kBroadcast };
}

/// Statistics of a card, by index.
enum GtCount : std::uint32_t { kReceived, kSent, kMissed, kReads, kWrites };

/// Properties of the ring that a card's registers show.
struct GtRing {
  std::uint32_t nodes = 1;      ///< number of nodes
  std::uint32_t upstream = 0;   ///< node id of the preceding node
  std::int64_t latency_ns = 0;  ///< time of a message around the ring; 0: not known
  bool closed = true;           ///< the ring is closed, so that a signal arrives
};

/// @param now  time on the card's clock [ns]
void power_up_gt(GtCard& card, std::int64_t now = now_ns());
[[nodiscard]] std::uint32_t read_cr(const GtCard& card, std::uint32_t index, const GtRing& ring,
                                    std::int64_t now = now_ns());
/// Writes to read-only registers are ignored.
void write_cr(GtCard& card, std::uint32_t index, std::uint32_t value, std::int64_t now = now_ns());

enum class StateResult { Ok, BadParameter, Unsupported };
/// @returns 0xFFFFFFFF if there is no such state
[[nodiscard]] std::uint32_t get_state(const GtCard& card, std::uint32_t state, const GtRing& ring,
                                      std::int64_t now = now_ns());
[[nodiscard]] StateResult set_state(GtCard& card, std::uint32_t state, std::uint32_t value,
                                    std::int64_t now = now_ns());

/// True if a card's registers let an interrupt in that has reached it. Its type and id may be
/// anything; a unicast interrupt is not checked for the card's node id.
[[nodiscard]] bool accepts(const GtCard& card, std::uint32_t type, std::uint32_t id);

[[nodiscard]] std::uint32_t node_id(const GtCard& card);
[[nodiscard]] bool is_set(const GtCard& card, std::uint32_t index, std::uint32_t bits);

}  // namespace rths::scramnet
