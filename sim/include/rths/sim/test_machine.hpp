// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>

#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/composition.hpp>

namespace rths::sim {

/// Largest load of the SRMD's vertical actuators (Table 1 of the paper) [N].
inline constexpr double kVerticalCapacity = 53.4e6;

/// Limits of one axis of a test machine.
struct AxisLimits {
  double stroke = 0;    ///< ± [m]
  double velocity = 0;  ///< ± [m/s]
  double force = 0;     ///< ± [N]
};

/// One horizontal axis of a servo-hydraulic bearing test machine: all its actuators as one.
///
///     servo        w = K_v (r(t − τ) − x) A/Q_r − K_p (P_L − P_f)/P_s     valve demand, |w| ≤ 1
///     washout      Ṗ_f = ω_f (P_L − P_f)                                  0 without it
///     spool        ẍ_v = ω_v² (w − x_v) − 2 ζ_v ω_v ẋ_v                   |x_v| ≤ 1
///     port flow    Q = Q_r y √(1 − sgn(y) P_L/P_s)
///                  y = x_v − d sgn(x_v) outside the dead band ± d, else 0
///     oil column   Ṗ_L = (4 B/V) (Q − A ẋ − C_l P_L)
///     platen       m_e ẍ = A P_L − F_machine − F_specimen
///     table force  A P_L + offset + noise, measured by the load cells of the actuators
///
/// Standard equations of servo-hydraulics (Merritt 1967). F_machine is the sum of the machine's
/// terms, mainly friction. The table force contains it and the platen's inertia, so a hybrid test
/// has to correct it.
struct ServoAxis {
  AxisLimits limits;
  double piston_area = 0.43;        ///< A [m²]
  double oil_volume = 1.05;         ///< V, both chambers [m³]
  double bulk_modulus = 1.4e9;      ///< B [Pa]
  double supply_pressure = 20.7e6;  ///< P_s [Pa]
  double leakage = 2e-10;           ///< C_l [m³/(s·Pa)]
  double rated_flow = 0.95;         ///< Q_r, valve fully open, no load [m³/s]
  double valve_frequency = 12;      ///< ω_v/2π [Hz]
  double valve_damping = 0.8;       ///< ζ_v [-]
  double dead_band = 0.005;         ///< of the spool [-]
  double position_gain = 20.5;      ///< K_v [1/s]
  double pressure_gain = 0.1;       ///< K_p [-]
  double pressure_washout = 0;      ///< ω_f/2π: slower pressure is not fed back [Hz]
  double transport_delay = 0.002;   ///< τ [s]
  double effective_mass = 113'371;  ///< m_e of platen and moving parts [kg]
  double force_offset = 2'000;      ///< of the table force [N]
};

/// Standard deviations of the sensors' white normal noise.
struct SensorNoiseLevels {
  double displacement = 5e-5;       ///< [m]
  double force = 5e3;               ///< [N]
  double acceleration = 0.0490333;  ///< [m/s²]
};

/// A bearing test machine with two horizontal axes and a specimen.
struct TestMachine {
  std::array<ServoAxis, kHorizontalAxes> axes;
  /// Effects missing in the equations above: actuator terms act on the reference, motion terms
  /// between platen and specimen, machine terms on the platen, sensor terms on the measurements.
  std::vector<TermSettings> terms;
  SensorNoiseLevels noise;
  bool has_specimen = true;  ///< false: an empty table
  bool has_rollers = false;  ///< of an empty table: they carry its vertical load without friction
  Bearing specimen;
  std::uint64_t seed = 1;
};

/// The machine's measurements, long and lat.
struct MachineFeedback {
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();  ///< [m/s²]
  Eigen::Vector2d force = Eigen::Vector2d::Zero();         ///< table force [N]
  double axial_load = 0;                                   ///< compression [N]
};

/// The machine in motion. Allocates when built, never in `step`.
class TestMachineRun {
 public:
  /// @param period  of `step` [s]; integrated in substeps of at most 0.1 ms
  /// @throws Error if a parameter is outside its physical range, a term's owner cannot have it, or
  ///         the model is too stiff or too fast for these substeps   @setup
  TestMachineRun(const TestMachine& machine, double period);

  /// One period with the references held.
  /// @param reference  what the servo receives: long, lat [m]
  /// @param axial_load  on the specimen, compression [N]
  /// @returns LimitExceeded if the stroke, velocity or force of an axis was at its limit; the
  ///          reference is clamped to the stroke   @realtime
  [[nodiscard]] Status step(const Eigen::Vector2d& reference, double axial_load,
                            MachineFeedback& feedback) RTHS_REALTIME;

  /// True state, without sensor errors: displacement [m] and specimen force [N].
  [[nodiscard]] Eigen::Vector2d true_displacement() const;
  [[nodiscard]] const Eigen::Vector2d& specimen_force() const { return specimen_force_; }

 private:
  struct AxisState {
    double x = 0, v = 0, pressure = 0, slow_pressure = 0, spool = 0, spool_rate = 0;
  };
  struct Axis {
    AxisState state;
    std::vector<double> delay_line;
    std::size_t delay_head = 0;
  };

  /// The machine's terms of one stage, with their state.
  struct Terms {
    Composition composition;
    std::vector<double> state;
    void run(Quantities<double>& q) noexcept { composition.advance(state, q); }
  };

  [[nodiscard]] static Terms terms_of(const TestMachine& machine, Stage stage, double time_step);
  [[nodiscard]] Quantities<double> motion() const noexcept;
  [[nodiscard]] Eigen::Vector2d through_actuator_terms(const Eigen::Vector2d& reference) noexcept;
  void integrate_substep(const Eigen::Vector2d& reference, double axial_load) noexcept;
  void measure(double axial_load, MachineFeedback& feedback) noexcept;
  void integrate_substep(int axis, double reference) noexcept;
  [[nodiscard]] AxisState rates(int axis, const AxisState& s, double reference,
                                double resistance) const noexcept;
  [[nodiscard]] double platen_acceleration(int axis, const AxisState& s,
                                           double resistance) const noexcept;
  [[nodiscard]] bool at_limit(int axis) const noexcept;
  [[nodiscard]] double draw(double standard_deviation) noexcept;

  TestMachine machine_;
  int substeps_;
  double substep_;  ///< [s]
  double time_ = 0;
  std::array<Axis, kHorizontalAxes> axes_;
  Terms actuator_, platen_, sensors_;
  BearingRun specimen_;  ///< with the machine's motion terms in front of it
  Eigen::Vector2d specimen_force_ = Eigen::Vector2d::Zero();
  /// Of specimen and machine together, now and one substep before [N].
  Eigen::Vector2d resistance_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_resistance_ = Eigen::Vector2d::Zero();
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// Friction of the SRMD's axes as a configuration of terms: the defaults under a [machine] table.
[[nodiscard]] Config srmd_terms();

/// The SRMD's axes: limits from Table 1 of the paper; the hydraulics have realistic magnitudes but
/// are not measured.
[[nodiscard]] TestMachine srmd_machine();

}  // namespace rths::sim
