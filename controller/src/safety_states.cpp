// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/safety_states.hpp>

#include <array>

namespace rths::controller {
namespace {

#define RTHS_SAFETY_TRANSITION(from, event, to) \
  SafetyTransition{SafetyState::from, SafetyEvent::event, SafetyState::to},
constexpr SafetyTransition kTransitions[] = {
#include "safety_table.inc"
};
#undef RTHS_SAFETY_TRANSITION

constexpr std::size_t index_of(SafetyState state, SafetyEvent event) {
  return static_cast<std::size_t>(state) * kSafetyEvents + static_cast<std::size_t>(event);
}

constexpr auto next_states() {
  std::array<SafetyState, std::size_t{kSafetyStates} * kSafetyEvents> next{};
  for (std::size_t i = 0; i < next.size(); ++i)
    next[i] = static_cast<SafetyState>(i / kSafetyEvents);
  for (const auto& row : kTransitions) next[index_of(row.from, row.event)] = row.to;
  return next;
}
constexpr auto kNext = next_states();

}  // namespace

SafetyState next_state(SafetyState state, SafetyEvent event) noexcept {
  return kNext[index_of(state, event)];
}

std::span<const SafetyTransition> safety_transitions() { return kTransitions; }

const char* to_text(SafetyState state) noexcept {
  static constexpr const char* kStates[] = {"off",  "ready",     "running",
                                            "hold", "ramp-down", "tripped"};
  return kStates[static_cast<std::size_t>(state)];
}

const char* to_text(SafetyEvent event) noexcept {
  static constexpr const char* kEvents[] = {
      "enable", "admit", "stop", "trip", "standstill", "rest", "rest after trip", "disable"};
  return kEvents[static_cast<std::size_t>(event)];
}

}  // namespace rths::controller
