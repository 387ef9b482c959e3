// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>

namespace rths::adapters {

/// Start of the handshake: newer controllers raise atTarget while idle. Older controllers raise it
/// only after their first target, so a solver must not wait for it before that target.
enum class Handshake { AtTargetFirst, TargetFirst };

/// Reads `handshake = "at_target_first"` (default) or "target_first".
/// @throws Error with its place for any other word   @setup
[[nodiscard]] Handshake read_handshake(const Config& table);

/// The numerical side of OpenFresco's handshake.
///
/// newTarget rises when a target is on the ring and falls when switchPC has risen. The specimen has
/// reached the target when switchPC has fallen and atTarget has risen. Every wait has a deadline.
class OpfHandshake {
 public:
  /// @param deadline  for each flag [s]
  explicit OpfHandshake(double deadline, Handshake controller = Handshake::AtTargetFirst)
      : deadline_{deadline},
        phase_{controller == Handshake::AtTargetFirst ? Phase::WaitForAtTarget : Phase::Ready} {}

  /// Advances with the flags at time `now` [s].
  /// @returns Fault, with a message, if a flag misses its deadline   @realtime
  [[nodiscard]] Status update(bool at_target, bool switch_pc, double now) RTHS_REALTIME;
  /// Whether the specimen is at its target: its feedback is valid, and a new target may be posted.
  [[nodiscard]] bool is_ready() const RTHS_REALTIME { return phase_ == Phase::Ready; }
  /// Reports a new target on the ring. @pre is_ready()   @realtime
  void post(double now) RTHS_REALTIME { enter(Phase::WaitForSwitch, now); }
  /// Restarts the deadline of the current wait.   @realtime
  void restart_deadline(double now) RTHS_REALTIME { entered_ = now; }
  /// Ends the test: no more targets.   @realtime
  void stop(double now) RTHS_REALTIME { enter(Phase::Stopping, now); }
  [[nodiscard]] bool is_stopping() const RTHS_REALTIME { return phase_ == Phase::Stopping; }
  /// Whether newTarget = −1 has been on the ring long enough to be read.   @realtime
  [[nodiscard]] bool has_stopped(double now) const RTHS_REALTIME;

  /// Value of newTarget: 1 new target, 0 none, −1 end of the test.   @realtime
  [[nodiscard]] double new_target() const RTHS_REALTIME;
  [[nodiscard]] const char* message() const RTHS_REALTIME { return message_; }

 private:
  enum class Phase { WaitForAtTarget, Ready, WaitForSwitch, WaitForRelease, Stopping };
  void enter(Phase phase, double now) RTHS_REALTIME {
    phase_ = phase;
    entered_ = now;
  }
  [[nodiscard]] Status wait_for(bool flag, Phase next, const char* otherwise,
                                double now) RTHS_REALTIME;

  double deadline_;
  Phase phase_;
  double entered_ = 0;  ///< start of the phase [s]
  const char* message_ = "";
};

}  // namespace rths::adapters
