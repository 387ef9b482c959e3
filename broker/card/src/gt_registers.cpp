// SPDX-License-Identifier: Apache-2.0
#include <rths/card/gt_registers.hpp>

#include <array>
#include <ctime>

namespace rths::scramnet {
namespace {

constexpr std::uint32_t kNoState = 0xFFFF'FFFF;
constexpr std::int64_t kTimerTickNs = 8;

/// Location of a state: bits of a control register, or a word of its own if `index` has kOwn.
enum class RegisterAccess : std::uint8_t { ReadWrite, ReadOnly, Ignored, Inverted, OnlyZero };
struct RegisterState {
  std::uint32_t index, shift, mask;
  RegisterAccess access = RegisterAccess::ReadWrite;
};
constexpr std::uint32_t kOwn = 0x100;
constexpr std::uint32_t kWhole = 0xFFFF'FFFF;

constexpr auto kStates = [] {
  std::array<RegisterState, gt_state::kReadBypassEnable + 1> states{};
  const auto control = [](std::uint32_t shift) {
    return RegisterState{gt::kLinkControl, shift, 1};
  };
  const auto status = [](std::uint32_t shift) {
    return RegisterState{gt::kLinkStatus, shift, 1, RegisterAccess::ReadOnly};
  };
  states[gt_state::kNodeId] = {gt::kLinkControl, gt::kNodeIdShift, 0xFF};
  states[gt_state::kActiveLink] = control(4);
  states[gt_state::kLinkErrors] = {kOwn | 0, 0, kWhole, RegisterAccess::Ignored};
  states[gt_state::kWrap] = control(19);
  states[gt_state::kWriteMeLast] = control(20);
  states[gt_state::kUnicastMask] = {gt::kUnicastMask, 0, 1};
  states[gt_state::kBroadcastMask] = {gt::kBroadcastMask, 0, kWhole};
  states[gt_state::kInterruptSelf] = control(21);
  states[gt_state::kRingSize] = {gt::kLinkStatus, 24, 0xFF, RegisterAccess::ReadOnly};
  states[gt_state::kUpstreamNodeId] = {gt::kMisc, 24, 0xFF, RegisterAccess::ReadOnly};
  states[gt_state::kNetTimer] = {gt::kTimer, 0, kWhole};
  states[gt_state::kLatencyTimer] = {gt::kLatency, 0, kWhole};
  states[gt_state::kTrafficCount] = {kOwn | 2, 0, kWhole};
  states[gt_state::kSpyTrafficCount] = {kOwn | 3, 0, kWhole};
  states[gt_state::kSpyNodeId] = {gt::kLinkControl, 24, 0xFF};
  states[gt_state::kTransmitEnable] = control(16);
  states[gt_state::kReceiveEnable] = control(17);
  states[gt_state::kRetransmitEnable] = control(18);
  states[gt_state::kLaser0Enable] = control(0);
  states[gt_state::kLaser1Enable] = control(1);
  states[gt_state::kLinkUp] = status(17);
  states[gt_state::kLaser0Signal] = status(18);
  states[gt_state::kLaser1Signal] = status(19);
  states[gt_state::kD64Enable] = {gt::kUser, 4, 1, RegisterAccess::Inverted};
  states[gt_state::kByteSwapEnable] = {gt::kUser, 1, 1, RegisterAccess::OnlyZero};
  states[gt_state::kWordSwapEnable] = {gt::kUser, 0, 1, RegisterAccess::OnlyZero};
  states[gt_state::kLinkErrorInterrupt] = {kOwn | 4, 0, 1};
  states[gt_state::kReadBypassEnable] = {kOwn | 5, 0, 1};
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
  if (type == gt_interrupt::kUnicast) return is_set(card, gt::kUnicastMask, 1);
  return type == gt_interrupt::kBroadcast && id < 32 && is_set(card, gt::kBroadcastMask, 1U << id);
}

std::uint32_t get_state(const GtCard& card, std::uint32_t id, const GtRing& ring,
                        std::int64_t now) {
  if (id >= kStates.size()) return kNoState;
  const RegisterState& state = kStates[id];
  const bool own = (state.index & kOwn) != 0;
  const std::uint32_t word =
      own ? card.own[state.index & ~kOwn].load() : read_cr(card, state.index, ring, now);
  const std::uint32_t value = word >> state.shift & state.mask;
  if (id == gt_state::kRingSize) return value + 1;
  return state.access == RegisterAccess::Inverted ? 1 - value : value;
}

StateResult set_state(GtCard& card, std::uint32_t id, std::uint32_t value, std::int64_t now) {
  if (id >= kStates.size()) return StateResult::BadParameter;
  const RegisterState& state = kStates[id];
  if (state.access == RegisterAccess::ReadOnly) return StateResult::BadParameter;
  if (state.access == RegisterAccess::Ignored) return StateResult::Ok;
  if (state.access == RegisterAccess::OnlyZero && value != 0) return StateResult::Unsupported;
  if (state.mask == 1 && id != gt_state::kUnicastMask) value = value != 0 ? 1 : 0;
  if (state.access == RegisterAccess::Inverted) value = 1 - value;
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
