// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// States of the safety layer in front of a machine. docs/safety.md has the transition table.
enum class SafetyState : std::uint8_t {
  Off,       ///< at its rest position; passes no command
  Ready,     ///< at its rest position; waits for the first command
  Running,   ///< passes the command
  Hold,      ///< brakes and stands still
  RampDown,  ///< moves to the rest position
  Tripped,   ///< at its rest position after a trip, until disabled
};
inline constexpr int kSafetyStates = 6;

enum class SafetyEvent : std::uint8_t {
  Enable,
  Admit,          ///< the first command is near the machine's position
  Stop,           ///< the operator or the end of the run
  Trip,           ///< a limit or a guard
  Standstill,     ///< the command has stood for the time of holding
  Rest,           ///< the command has reached the rest position
  RestAfterTrip,  ///< the same, after a trip
  Disable,
};
inline constexpr int kSafetyEvents = 8;

/// The next state; the same state if the table does not list the event.   @realtime
[[nodiscard]] SafetyState next_state(SafetyState state, SafetyEvent event) RTHS_REALTIME;

/// A row of the transition table.
struct SafetyTransition {
  SafetyState from;
  SafetyEvent event;
  SafetyState to;
};
[[nodiscard]] std::span<const SafetyTransition> safety_transitions();

/// Names for messages and documents: "ramp-down", "rest after trip".
[[nodiscard]] const char* to_text(SafetyState state) RTHS_REALTIME;
[[nodiscard]] const char* to_text(SafetyEvent event) RTHS_REALTIME;

}  // namespace rths::controller
