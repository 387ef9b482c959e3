// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <rths/controller/inverse_lead.hpp>
#include <rths/controller/predictor_corrector.hpp>
#include <rths/controller/target_force.hpp>
#include <rths/loop/force_feedback.hpp>
#include <rths/loop/tick_order.hpp>
#include <rths/sim/axis_transfer.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/structure_model.hpp>
#include <rths/sim/test_machine.hpp>

namespace rths::budget {

/// A part of a hybrid test that its simulation describes differently.
enum class Part : unsigned {
  Tracking,   ///< transfer system: command to displacement
  Force,      ///< measurement and correction of the force
  Specimen,   ///< bearing
  Machine,    ///< friction, inertia and offset of the platen
  Numerical,  ///< step of the integration, prediction, time of computing
  Host,       ///< lateness of controller and machine, and of the targets
};
inline constexpr std::size_t kParts = 6;

/// The parts that are as identified, the others are as simulated: bit i is Part i.
using Parts = unsigned;
[[nodiscard]] constexpr bool has(Parts parts, Part part) {
  return (parts >> static_cast<unsigned>(part) & 1U) != 0;
}
[[nodiscard]] constexpr Parts only(Part part) { return 1U << static_cast<unsigned>(part); }
inline constexpr Parts kNone = 0, kAll = (1U << kParts) - 1;

/// Lead of the reference over the command of one axis: a0 x + a1 ẋ + a2 ẍ.
using Lead = Eigen::Vector3d;

/// An adaptive inverse as it ran along one axis.
struct SentInverse {
  controller::InverseLeadSettings settings;
  std::vector<controller::InverseLead::Terms> coefficients;  ///< as sent, by controller tick
};

/// Compensation of one axis, as sent, by controller tick; the last tick's holds for later ones. No
/// leads: none.
using Compensation = std::variant<std::vector<Lead>, SentInverse>;

/// Noise of the sensors of one axis, by tick of the machine, as recorded; may be empty.
struct MeasuredNoise {
  std::vector<double> displacement;  ///< [m]
  std::vector<double> acceleration;  ///< [m/s²]
  std::vector<double> force;         ///< of the load cells [N]
};

/// The machine with the load-dependent friction that the correction subtracts, if it has none of
/// its own.   @setup
[[nodiscard]] sim::TestMachine with_known_friction(sim::TestMachine machine,
                                                   const loop::ForceCorrection& correction);

/// A hybrid test with two horizontal axes, each part as simulated and as identified.
struct HybridTest {
  // The analysis
  std::shared_ptr<const sim::StructureModel> structure;
  sim::GroundMotion motion;
  double alpha = -0.05;                    ///< of α-OS
  double implicit_stiffness = 0;           ///< of a bearing [N/m]
  double duration = 0;                     ///< model time [s]
  std::array<bool, 2> tested{true, true};  ///< axes; others have neither motion nor target

  // Numerical side, as identified
  double integration_step = 0.01;                  ///< model time [s]
  int substeps = 1;                                ///< of the integration between targets
  double rate = 1;                                 ///< wall time over model time
  controller::PredictorCorrectorSettings command;  ///< its targets carry no rates
  std::array<int, 2> sampling_delay{};  ///< of the feedback behind the command [substeps]
  /// Order and arrivals as identified. The times of computing are those of a host that is never
  /// late.
  loop::Host host;

  // Controller
  double period = 0.001;  ///< wall time [s]
  loop::ForceCorrection correction;
  /// Correction for the tracking error; acts if that is as identified.
  std::optional<controller::TargetForceSettings> target_force;
  /// It takes the displacement that waits for the accelerometer, like the corrected force.
  bool target_force_waits = false;
  std::array<MeasuredNoise, 2> noise;
  std::array<Compensation, 2> compensation;

  // Specimen and machine. Of the machines, the loop uses terms, masses and offsets; of the
  // identified one its hydraulics too.
  sim::Bearing specimen_simulated, specimen_identified;
  sim::TestMachine machine_simulated, machine_identified;
  /// Measured vertical load by machine tick [N]; empty: that of the analysis.
  std::vector<double> axial_load;
};

/// Noise of a signal that is sampled much faster than it changes: each sample less the parabola
/// through it and its `reach` neighbours on either side. A noise of variance 1 keeps the variance
/// 1 − w, where w = (9/4)/(2 reach + 1) for a long reach; the rest is taken for signal.
/// Source: Savitzky & Golay (1964).   @setup
[[nodiscard]] std::vector<double> noise_of(const std::vector<double>& signal, std::size_t reach);

/// Noise of the sensors in the records of both axes of a machine: what the identified laboratory,
/// moved by the recorded references, leaves of the measured signals, and no parabola through 801
/// samples follows. It stays within three standard deviations of the noise at rest, before the
/// first target, so that an error of the model is not taken for noise.   @setup
[[nodiscard]] std::array<MeasuredNoise, 2> sensor_noise(
    const HybridTest& test, const std::array<sim::TransferRecord, 2>& records);

/// Displacement of the bearing, one sample per integration step: long, lat [m]. Sample k is at
/// (k + 1) integration_step.
using Response = std::array<std::vector<double>, 2>;

/// The closed loop in virtual time. Parts as simulated: an ideal transfer system with the actuator
/// terms of the simulated machine, an exact force, the simulated bearing and machine, an
/// integration with a target per controller period, and a host that is never late.
/// @param identified  parts that are as identified
/// @throws Error as TestMachineRun and the structure do   @setup
[[nodiscard]] Response closed_loop(const HybridTest& test, Parts identified);

/// The analysis alone, with the recorded force in place of everything else: what differs from the
/// recorded targets is the error of the numerical side.
/// @param force  fed to the integrator at the end of each integration step: long, lat [N]   @setup
[[nodiscard]] Response replayed(const HybridTest& test,
                                const std::array<std::vector<double>, 2>& force);

}  // namespace rths::budget
