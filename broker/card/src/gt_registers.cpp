// SPDX-License-Identifier: Apache-2.0
#include <rths/card/gt_registers.hpp>

#include <array>
#include <ctime>

#include <gtucore.h>

namespace rths::scramnet {
namespace {

constexpr std::uint32_t kNoState = 0xFFFF'FFFF;
constexpr std::int64_t kTimerTickNs = 8;

/// Location of a state: bits of a control register, or a word of its own if `index` has kOwn.
enum class Access : std::uint8_t { ReadWrite, ReadOnly, Ignored, Inverted, OnlyZero };
struct State {
  std::uint32_t index, shift, mask;
  Access access = Access::ReadWrite;
};
constexpr std::uint32_t kOwn = 0x100;
constexpr std::uint32_t kWhole = 0xFFFF'FFFF;

constexpr auto kStates = [] {
  std::array<State, SCGT_READ_BYPASS_ENABLE + 1> states{};
  const auto control = [](std::uint32_t shift) { return State{gt::kLinkControl, shift, 1}; };
  const auto status = [](std::uint32_t shift) {
    return State{gt::kLinkStatus, shift, 1, Access::ReadOnly};
  };
  states[SCGT_NODE_ID] = {gt::kLinkControl, gt::kNodeIdShift, 0xFF};
  states[SCGT_ACTIVE_LINK] = control(4);
  states[SCGT_NUM_LINK_ERRS] = {kOwn | 0, 0, kWhole, Access::Ignored};
  states[SCGT_EWRAP] = control(19);
  states[SCGT_WRITE_ME_LAST] = control(20);
  states[SCGT_UNICAST_INT_MASK] = {gt::kUnicastMask, 0, 1};
  states[SCGT_BROADCAST_INT_MASK] = {gt::kBroadcastMask, 0, kWhole};
  states[SCGT_INT_SELF_ENABLE] = control(21);
  states[SCGT_RING_SIZE] = {gt::kLinkStatus, 24, 0xFF, Access::ReadOnly};
  states[SCGT_UPSTREAM_NODE_ID] = {gt::kMisc, 24, 0xFF, Access::ReadOnly};
  states[SCGT_NET_TIMER_VAL] = {gt::kTimer, 0, kWhole};
  states[SCGT_LATENCY_TIMER_VAL] = {gt::kLatency, 0, kWhole};
  states[SCGT_SM_TRAFFIC_CNT] = {kOwn | 2, 0, kWhole};
  states[SCGT_SPY_SM_TRAFFIC_CNT] = {kOwn | 3, 0, kWhole};
  states[SCGT_SPY_NODE_ID] = {gt::kLinkControl, 24, 0xFF};
  states[SCGT_TRANSMIT_ENABLE] = control(16);
  states[SCGT_RECEIVE_ENABLE] = control(17);
  states[SCGT_RETRANSMIT_ENABLE] = control(18);
  states[SCGT_LASER_0_ENABLE] = control(0);
  states[SCGT_LASER_1_ENABLE] = control(1);
  states[SCGT_LINK_UP] = status(17);
  states[SCGT_LASER_0_SIGNAL_DET] = status(18);
  states[SCGT_LASER_1_SIGNAL_DET] = status(19);
  states[SCGT_D64_ENABLE] = {gt::kUser, 4, 1, Access::Inverted};
  states[SCGT_BYTE_SWAP_ENABLE] = {gt::kUser, 1, 1, Access::OnlyZero};
  states[SCGT_WORD_SWAP_ENABLE] = {gt::kUser, 0, 1, Access::OnlyZero};
  states[SCGT_LINK_ERR_INT_ENABLE] = {kOwn | 4, 0, 1};
  states[SCGT_READ_BYPASS_ENABLE] = {kOwn | 5, 0, 1};
  return states;
}();

}  // namespace

void power_up_gt(GtCard& card, std::int64_t now) {
  for (auto& cr : card.cr) cr.store(0);
  for (auto& own : card.own) own.store(0);
  card.cr[gt::kLinkControl].store(gt::kLinkAtPowerUp);
  card.timer_since_ns.store(now);
}

std::uint32_t node_id(const GtCard& card) {
  return card.cr[gt::kLinkControl].load() >> gt::kNodeIdShift & 0xFF;
}

bool is_set(const GtCard& card, std::uint32_t index, std::uint32_t bits) {
  return (card.cr[index].load() & bits) == bits;
}

std::uint32_t read_cr(const GtCard& card, std::uint32_t index, const GtRing& ring,
                      std::int64_t now) {
  switch (index) {
    case gt::kLinkStatus:
      return (ring.closed ? gt::kLinkUp | gt::kSignal0 | gt::kSignal1 : 0U) | (ring.nodes - 1)
                                                                                  << 24;
    case gt::kMisc:
      return ring.upstream << 24 | (card.cr[index].load() & 0x00FF'FFFF);
    case gt::kTimer:
      return static_cast<std::uint32_t>((now - card.timer_since_ns.load()) / kTimerTickNs) +
             card.cr[index].load();
    case gt::kLatency:  // messages that the card sends by itself set it all the time
      if (ring.latency_ns != 0) return static_cast<std::uint32_t>(ring.latency_ns / kTimerTickNs);
      return card.cr[index].load();
    default:
      return card.cr[index].load();
  }
}

void write_cr(GtCard& card, std::uint32_t index, std::uint32_t value, std::int64_t now) {
  if (index == gt::kBoardInfo || index == gt::kLinkStatus) return;
  if (index == gt::kTimer) card.timer_since_ns.store(now);
  card.cr[index].store(value);
}

bool accepts(const GtCard& card, std::uint32_t type, std::uint32_t id) {
  if (!is_set(card, gt::kLinkControl, gt::kReceive)) return false;
  if (type == SCGT_UNICAST_INTR) return is_set(card, gt::kUnicastMask, 1);
  return type == SCGT_BROADCAST_INTR && id < 32 && is_set(card, gt::kBroadcastMask, 1U << id);
}

std::uint32_t get_state(const GtCard& card, std::uint32_t id, const GtRing& ring,
                        std::int64_t now) {
  if (id >= kStates.size()) return kNoState;
  const State& state = kStates[id];
  const bool own = (state.index & kOwn) != 0;
  const std::uint32_t word =
      own ? card.own[state.index & ~kOwn].load() : read_cr(card, state.index, ring, now);
  const std::uint32_t value = word >> state.shift & state.mask;
  if (id == SCGT_RING_SIZE) return value + 1;
  return state.access == Access::Inverted ? 1 - value : value;
}

StateResult set_state(GtCard& card, std::uint32_t id, std::uint32_t value, std::int64_t now) {
  if (id >= kStates.size()) return StateResult::BadParameter;
  const State& state = kStates[id];
  if (state.access == Access::ReadOnly) return StateResult::BadParameter;
  if (state.access == Access::Ignored) return StateResult::Ok;
  if (state.access == Access::OnlyZero && value != 0) return StateResult::Unsupported;
  if (state.mask == 1 && id != SCGT_UNICAST_INT_MASK) value = value != 0 ? 1 : 0;
  if (state.access == Access::Inverted) value = 1 - value;
  const std::uint32_t field = state.mask << state.shift;
  const std::uint32_t bits = (value & state.mask) << state.shift;
  if ((state.index & kOwn) != 0) {
    card.own[state.index & ~kOwn].store(bits);
  } else {
    const std::uint32_t before = card.cr[state.index].load();
    write_cr(card, state.index, (before & ~field) | bits, now);
  }
  return StateResult::Ok;
}

}  // namespace rths::scramnet
