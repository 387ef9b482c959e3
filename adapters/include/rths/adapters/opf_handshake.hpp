// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>

namespace rths::adapters {

/// How a controller begins: the newer generation raises atTarget while it is idle, the older one
/// only after its first target, so who waits for that would wait for ever.
enum class Handshake { AtTargetFirst, TargetFirst };

/// Reads `handshake = "at_target_first"`, which is the default, or "target_first".
/// @throws Error with its place if it is another word   @setup
[[nodiscard]] Handshake read_handshake(const Config& table);

/// The numerical side of OpenFresco's handshake: newTarget rises when a target stands on the ring,
/// falls when switchPC has risen, and the specimen is there when switchPC has fallen and atTarget
/// has risen. A line at a time; nothing waits for ever.
class OpfHandshake {
 public:
  /// @param deadline  for each flag [s]
  explicit OpfHandshake(double deadline, Handshake controller = Handshake::AtTargetFirst)
      : deadline_{deadline},
        phase_{controller == Handshake::AtTargetFirst ? Phase::WaitForTarget : Phase::There} {}

  /// Looks at the flags, at a time [s]. @returns Fault, with a message, if one is overdue @realtime
  [[nodiscard]] Status look(bool at_target, bool switch_pc, double now) RTHS_REALTIME;
  /// Whether the specimen is where it was told to be: its feedback is valid, a target is welcome.
  [[nodiscard]] bool is_there() const RTHS_REALTIME { return phase_ == Phase::There; }
  /// A target stands on the ring. @pre is_there()   @realtime
  void post(double now) RTHS_REALTIME { enter(Phase::WaitForSwitch, now); }
  /// Forgets how long it has waited.   @realtime
  void be_patient(double now) RTHS_REALTIME { entered_ = now; }
  /// No more targets.   @realtime
  void leave(double now) RTHS_REALTIME { enter(Phase::Leave, now); }
  [[nodiscard]] bool is_leaving() const RTHS_REALTIME { return phase_ == Phase::Leave; }
  /// Whether the word that says so has stood there for long enough.   @realtime
  [[nodiscard]] bool has_left(double now) const RTHS_REALTIME;

  /// The word: 1 a target is there, 0 none, −1 no more.   @realtime
  [[nodiscard]] double new_target() const RTHS_REALTIME;
  [[nodiscard]] const char* message() const RTHS_REALTIME { return message_; }

 private:
  enum class Phase { WaitForTarget, There, WaitForSwitch, WaitForRelease, Leave };
  void enter(Phase phase, double now) RTHS_REALTIME {
    phase_ = phase;
    entered_ = now;
  }
  [[nodiscard]] Status wait_for(bool flag, Phase next, const char* otherwise,
                                double now) RTHS_REALTIME;

  double deadline_;
  Phase phase_;
  double entered_ = 0;  ///< when the phase began [s]
  const char* message_ = "";
};

}  // namespace rths::adapters
