// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <random>
#include <vector>

#include <Eigen/Core>

#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>
#include <rths/sim/machine/platen_machine.hpp>

namespace rths::sim::machine {

/// References of one period.
struct PlatenReference {
  Vector6 displacement = Vector6::Zero();  ///< long, lat, vert [m], roll, pitch, yaw [rad]
  double axial_load = 0;                   ///< compression of the specimen [N]
  double feed_forward = 0;                 ///< at the valves of the horizontal actuators, 0…2 [-]
};

/// Measurements of one instant.
struct PlatenFeedback {
  Vector6 displacement = Vector6::Zero();                  ///< [m], [rad]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< of the centre of mass [m/s²]
  /// Of all actuators: long, lat, vert less the platen's weight [N]; moments about the centre of
  /// mass [N·m].
  Vector6 force = Vector6::Zero();
  std::array<double, kArms> outrigger_force{};  ///< upwards: ne, se, nw, sw [N]
};

/// Second-order Butterworth low-pass of a transducer, for one signal. Bilinear, pre-warped.
class TransducerFilter {
 public:
  TransducerFilter() = default;
  TransducerFilter(double cutoff, double period);
  [[nodiscard]] double operator()(double input) RTHS_REALTIME;
  void reset(double input) RTHS_REALTIME;  ///< as after a long time at `input`

 private:
  double b0_ = 1, a1_ = 0, a2_ = 0, z1_ = 0, z2_ = 0;
};

/// Powers and energies, for balances.
struct PlatenEnergy {
  double kinetic = 0;     ///< of the platen [J]
  double potential = 0;   ///< of the platen's weight [J]
  double oil = 0;         ///< Σ ½ A² P²/k over the oil columns [J]
  double outriggers = 0;  ///< in the pads' springs [J]
};

/// The machine in motion. Allocates when built, never in `step`.
///
/// The platen and its actuators are integrated by the midpoint rule in substeps of at most 0.1 ms.
/// Friction is advanced exactly. Its force and the specimen's shear are computed at the end of each
/// substep and extrapolated over the next one.
class PlatenRun {
 public:
  /// At rest, with the specimen under its axial load.
  /// @param period  of `step` [s]
  /// @throws Error if a parameter is outside its range or too fast for the substeps   @setup
  PlatenRun(const PlatenMachine& machine, double period);

  /// One period with the references held.
  /// @returns LimitExceeded if a coordinate of the platen was at a limit; references are clamped to
  ///          the strokes, and NaN holds the platen   @realtime
  [[nodiscard]] Status step(const PlatenReference& reference,
                            PlatenFeedback& feedback) RTHS_REALTIME;

  /// True state, without errors of transducers.
  [[nodiscard]] const Pose& pose() const { return state_.pose; }
  [[nodiscard]] const Eigen::Vector3d& velocity() const { return state_.velocity; }  ///< [m/s]
  /// Shear of the specimen: long, lat [N].
  [[nodiscard]] const Eigen::Vector2d& specimen_force() const { return specimen_force_; }
  [[nodiscard]] double axial_load() const;  ///< compression of the specimen [N]
  [[nodiscard]] const ActuatorState& actuator(std::size_t i) const { return state_.actuators[i]; }
  [[nodiscard]] double supply_pressure() const;                                    ///< [Pa]
  [[nodiscard]] double friction_force(int axis) const { return friction_[axis]; }  ///< [N]
  [[nodiscard]] PlatenEnergy energy() const;

  /// Starts from the present place with these rates, as after a blow: long, lat, vert [m/s], roll,
  /// pitch, yaw about the platen's axes [rad/s].
  void strike(const Vector6& rates);

 private:
  struct State {
    Pose pose;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< floor's axes [m/s]
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< platen's axes [rad/s]
    std::array<ActuatorState, kActuators> actuators{};
    double gas = 0;  ///< volume in the accumulators [m³]
  };
  using Coordinates = std::array<Coordinate, kActuators>;
  struct Evaluation {
    State rates;
    Vector6 actuator_force = Vector6::Zero();  ///< of all actuators together
  };
  /// Per actuator, from mid-stroke [m], [m/s].
  struct Targets {
    std::array<double, kActuators> displacement{}, velocity{};
    double feed_forward = 0;
  };

  [[nodiscard]] Coordinates coordinates(const Pose& pose, const Eigen::Matrix3d& R) const noexcept;
  [[nodiscard]] double push_of(const State& s, const Eigen::Vector3d& arm, const Eigen::Vector3d& r,
                               const Eigen::Vector3d& spin) const noexcept;
  [[nodiscard]] Vector6 support_force(const State& s, const Eigen::Matrix3d& R) const noexcept;
  [[nodiscard]] Evaluation rates(const State& s, const Vector6& resistance) const noexcept;
  static void add(const State& from, const State& rates, double dt, State& to) noexcept;
  void integrate_substep() noexcept;
  void update_resistance() noexcept;
  [[nodiscard]] Eigen::Vector3d friction_arm(std::size_t surface,
                                             const Eigen::Matrix3d& R) const noexcept;
  [[nodiscard]] Eigen::Vector2d coulomb_of(std::size_t surface, const Eigen::Matrix3d& R,
                                           const Eigen::Vector3d& spin) const noexcept;
  void run_force_loop(double reference) noexcept;
  void set_targets(const PlatenReference& reference) noexcept;
  void filter(bool reset) noexcept;
  void settle();
  [[nodiscard]] double compression(const Pose& pose, const Eigen::Vector3d& velocity,
                                   const Eigen::Matrix3d& R) const noexcept;
  [[nodiscard]] Status limited() const noexcept;
  void measure(PlatenFeedback& feedback) noexcept;
  [[nodiscard]] double draw(double standard_deviation) noexcept;

  PlatenMachine machine_;
  int substeps_;
  double substep_;                           ///< [s]
  double period_;                            ///< [s]
  std::array<double, kActuators> middle_{};  ///< coordinates at mid-stroke [m]
  State state_;
  Evaluation now_;  ///< at the beginning of the last substep
  Targets targets_;
  std::array<double, kVertical> vertical_targets_{};  ///< without the force loop [m]
  std::vector<PlatenReference> delay_line_;
  std::size_t delay_head_ = 0;
  double force_correction_ = 0;  ///< of the vertical reference, by the force loop [m]
  double rest_height_ = 0;       ///< δ = z + rest height [m]
  std::array<Eigen::Vector2d, kSurfaces> deflection_{};
  Eigen::Vector2d friction_ = Eigen::Vector2d::Zero();
  BearingRun bearing_;
  Eigen::Vector2d specimen_force_ = Eigen::Vector2d::Zero();
  Vector6 resistance_ = Vector6::Zero(), last_resistance_ = Vector6::Zero();
  std::array<TransducerFilter, 6> displacement_filter_, force_filter_;
  std::array<TransducerFilter, 3> acceleration_filter_;
  Vector6 filtered_displacement_ = Vector6::Zero(), filtered_force_ = Vector6::Zero();
  Eigen::Vector3d filtered_acceleration_ = Eigen::Vector3d::Zero();
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace rths::sim::machine
