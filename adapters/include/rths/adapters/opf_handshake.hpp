// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>

namespace rths::adapters {

/// How targets are announced. Newer controllers raise atTarget while idle. Older controllers raise
/// it only after their first target, so a solver must not wait for it before that target.
/// Numbered: newTarget is 2 and 1 in turn, and atTarget returns the number. No flag has to fall in
/// between, so a target takes one tick of the controller instead of two.
enum class Handshake { AtTargetFirst, TargetFirst, Numbered };

/// Least ticks of a controller that reads the flags once per tick.
[[nodiscard]] constexpr int ticks_per_target(Handshake handshake) {
  return handshake == Handshake::Numbered ? 1 : 2;
}

/// Reads `handshake = "at_target_first"` (default), "target_first" or "numbered".
/// @throws Error with its place for any other word   @setup
[[nodiscard]] Handshake read_handshake(const Config& table);

/// The numerical side of OpenFresco's handshake.
///
/// newTarget rises when a target is on the ring and falls when switchPC has risen. The specimen has
/// reached the target when switchPC has fallen and atTarget has risen. With numbered targets,
/// atTarget alone counts. Every wait has a deadline.
class OpfHandshake {
 public:
  /// @param deadline  for each flag [s]
  explicit OpfHandshake(double deadline, Handshake controller = Handshake::AtTargetFirst)
      : deadline_{deadline},
        is_numbered_{controller == Handshake::Numbered},
        phase_{controller == Handshake::TargetFirst ? Phase::Ready : Phase::WaitForAtTarget} {}

  /// Advances with the words atTarget and switchPC at time `now` [s].
  /// @returns Fault, with a message, if a flag misses its deadline   @realtime
  [[nodiscard]] Status update(double at_target, double switch_pc, double now) RTHS_REALTIME;
  /// Whether the specimen is at its target: its feedback is valid, and a new target may be posted.
  [[nodiscard]] bool is_ready() const RTHS_REALTIME { return phase_ == Phase::Ready; }
  /// Reports a new target on the ring. @pre is_ready()   @realtime
  void post(double now) RTHS_REALTIME;
  /// Restarts the deadline of the current wait.   @realtime
  void restart_deadline(double now) RTHS_REALTIME { entered_ = now; }
  /// Ends the test: no more targets.   @realtime
  void stop(double now) RTHS_REALTIME { enter(Phase::Stopping, now); }
  [[nodiscard]] bool is_stopping() const RTHS_REALTIME { return phase_ == Phase::Stopping; }
  /// Whether newTarget = −1 has been on the ring long enough to be read.   @realtime
  [[nodiscard]] bool has_stopped(double now) const RTHS_REALTIME;

  /// Value of newTarget: 1 new target, or its number; 0 none, −1 end of the test.   @realtime
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
  bool is_numbered_;
  double number_ = 0;  ///< of the newest target; 0 before the first
  Phase phase_;
  double entered_ = 0;  ///< start of the phase [s]
  const char* message_ = "";
};

}  // namespace rths::adapters
