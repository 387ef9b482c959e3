// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <rths/controller/safety_states.hpp>
#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Limits of one axis. An infinite limit is off.
struct SafetyLimits {
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  double displacement = kNone;  ///< of command and platen, and of the stopping distance ± [m]
  double velocity = kNone;      ///< of command and platen, mean over the window ± [m/s]
  double acceleration = kNone;  ///< of the command, over the window ± [m/s²]
  double jerk = kNone;          ///< of the command, over the window ± [m/s³]
  double jump = kNone;          ///< of the command in one period ± [m]
  double braking = 10;          ///< deceleration of a stop [m/s²], > 0
  /// Of a stop that returns the reference to rest instead [m/s], for a reference that leads the
  /// platen by a multiple of its motion: standing there, it would move the platen on.
  double return_speed = kNone;
  double force = kNone;          ///< measured ± [N]
  double tracking = kNone;       ///< platen from the command `response_delay` ago ± [m]
  double feedback_jump = kNone;  ///< of the measured displacement in one period ± [m]
  double force_jump = kNone;     ///< of the measured force in one period ± [N]
  double returned_work = kNone;  ///< that the platen returns after the most it received [J]
  double negative_work = kNone;  ///< that the platen returns beyond all it received [J]
};

struct SafetySettings {
  double period = 1e-3;           ///< of `step` [s]
  double window = 0.04;           ///< of velocity, acceleration and jerk [s]
  double response_delay = 0.06;   ///< of the machine, for tracking and stuck feedback [s]
  double start_distance = 0.005;  ///< largest distance of the first command from the platen [m]
  double stuck = 0.005;           ///< feedback that repeats one value for this time is stuck [s],
  double stuck_motion = 0.001;    ///< while the expected motion exceeds this [m]
  double hold = 0.2;              ///< shortest time from a stop to the ramp-down [s]
  double ramp = 1.0;              ///< shortest time of the ramp-down [s]
  std::vector<SafetyLimits> axes;
};

/// Bound of the time from a trip or a stop to the rest position, from anywhere inside the limits;
/// at most two minutes [s].
[[nodiscard]] double longest_stop(const SafetySettings& settings);

enum class SafetyCause : std::uint8_t {
  None,
  CommandNotFinite,
  CommandDisplacement,
  CommandVelocity,
  CommandAcceleration,
  CommandJerk,
  CommandJump,
  FirstCommand,
  FeedbackNotFinite,
  FeedbackDisplacement,
  FeedbackVelocity,
  FeedbackJump,
  FeedbackStuck,
  Force,
  ForceJump,
  ForceStuck,
  ForceSign,
  Tracking,
  NodeSilent,
  NodeInvalid,
};
inline constexpr int kSafetyCauses = 20;
/// What is beyond its limit: "velocity of the command", with its unit.
struct SafetyCauseText {
  const char* quantity;
  const char* unit;
};
[[nodiscard]] SafetyCauseText to_text(SafetyCause cause) RTHS_REALTIME;

/// The first cause of a trip.
struct SafetyTrip {
  SafetyCause cause = SafetyCause::None;
  std::size_t axis = 0;  ///< or the node of NodeSilent and NodeInvalid
  double value = 0;      ///< found [unit of the cause]
  double limit = 0;      ///< [unit of the cause]
};

/// Measurements of one axis.
struct SafetyFeedback {
  double displacement = 0;  ///< [m]
  double force = 0;         ///< that moves platen and specimen [N]
};

/// The safety layer between any controller and a machine, for one set of axes.
///
/// A command is passed unchanged while it and a stop from it are inside the limits. The stop brakes
/// from the mean velocity of the window at `braking` and then stands, or returns to rest at
/// `return_speed`. The layer therefore always has a stop that it has checked, so its output stays
/// inside the limits for every input:
///
///     |r(t)| ≤ X,  |r(t) − r(t−h)| ≤ J,  |Δr| ≤ V T,  |Δ²r| ≤ A T²,  |Δ³r| ≤ B T³
///
/// with Δr = r(t) − r(t−T) over the window T. A braking stop also bounds |x| + v²/2a by X. A trip
/// or a stop acts on all axes: they brake, stand, and return to the rest position along a cosine
/// bell.
/// One thread.
class Safety {
 public:
  /// @throws Error if a setting is out of range   @setup
  explicit Safety(const SafetySettings& settings);

  /// @param rest  rest position of each axis [m]   @realtime
  void enable(std::span<const double> rest) RTHS_REALTIME;
  /// Goes off if it is at rest; else stops.   @realtime
  void disable() RTHS_REALTIME;
  /// Stops as at the end of a run. May be called before every `step`.   @realtime
  void stop() RTHS_REALTIME;
  /// Trips for a reason outside the axes, such as a silent node.   @realtime
  void trip(const SafetyTrip& trip) RTHS_REALTIME;

  /// One period.
  /// @param command   wanted reference of each axis [m]
  /// @param feedback  measured since the last call
  /// @param admits    false: a command is still awaited, so the layer does not leave Ready
  /// @returns the reference of each axis [m]   @realtime
  [[nodiscard]] std::span<const double> step(std::span<const double> command,
                                             std::span<const SafetyFeedback> feedback,
                                             bool admits) RTHS_REALTIME;

  [[nodiscard]] SafetyState state() const { return state_; }
  /// None if it has not tripped since `enable`.
  [[nodiscard]] const SafetyTrip& first_trip() const { return trip_; }
  [[nodiscard]] bool has_tripped() const { return trip_.cause != SafetyCause::None; }

 private:
  /// A stop: position [m] and velocity [m/s] at its begin.
  struct Stop {
    double from = 0, velocity = 0;
  };
  /// Command of one axis.
  struct Path {
    std::vector<double> line;  ///< the last 3 windows, then the references of a stop under test
    Stop stop;                 ///< from the last reference
    Stop wanted;               ///< from the command under test
    double rest = 0;           ///< [m]
  };
  /// Feedback of one axis.
  struct Sensor {
    std::vector<double> past;  ///< displacements of the last window, oldest first; ends with `last`
    SafetyFeedback last;
    /// Periods without a new value, and the expected displacement at the last new one [m].
    std::size_t repeated_displacement = 0, repeated_force = 0;
    double expected_displacement = 0, expected_force = 0;
    double work = 0, most_work = 0;  ///< on the platen since `enable` [J]
    bool has_values = false;
  };

  void act(SafetyEvent event) noexcept;
  /// Periods of a stop, and the position in it.
  [[nodiscard]] std::size_t stop_ticks(std::size_t axis, const Stop& stop) const noexcept;
  [[nodiscard]] double stop_at(std::size_t axis, const Stop& stop,
                               std::size_t ticks) const noexcept;
  [[nodiscard]] SafetyTrip find_in_command(std::size_t axis, double command) noexcept;
  [[nodiscard]] SafetyTrip find_in_stops(std::size_t axis, const Stop& full) noexcept;
  [[nodiscard]] SafetyTrip find_in_stop(std::size_t axis) noexcept;
  [[nodiscard]] SafetyTrip find_in_windows(std::size_t axis) noexcept;
  [[nodiscard]] SafetyTrip find_in_feedback(std::size_t axis,
                                            const SafetyFeedback& now) const noexcept;
  [[nodiscard]] SafetyTrip find_in_history(std::size_t axis) const noexcept;
  [[nodiscard]] double expected(std::size_t axis) const noexcept;
  void observe(std::size_t axis, const SafetyFeedback& now) noexcept;
  void judge_feedback(std::span<const SafetyFeedback> feedback) noexcept;
  void admit(std::span<const double> command, std::span<const SafetyFeedback> feedback) noexcept;
  void pass(std::span<const double> command) noexcept;
  void write(std::size_t axis, double reference) noexcept;
  void brake() noexcept;
  void begin_ramp() noexcept;
  void ramp_down() noexcept;

  SafetySettings settings_;
  std::size_t window_, delay_;  ///< [periods]
  SafetyState state_ = SafetyState::Off;
  SafetyTrip trip_;
  std::vector<Path> paths_;
  std::vector<Sensor> sensors_;
  std::vector<double> references_;
  std::size_t ticks_ = 0;  ///< since the stop, then since the ramp-down began
  double ramp_ = 0;        ///< of this ramp-down [s]
};

}  // namespace rths::controller
