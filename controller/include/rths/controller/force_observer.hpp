// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <rths/controller/filters.hpp>
#include <rths/core/realtime.hpp>

namespace rths::controller {

/// A test machine's own force along one axis, which its load cells add to the specimen's force:
///     F = m_e a + F_s sign(v) + F_d |v|^α sign(v) + d
/// Equation 1 of the paper; friction is zero below a velocity of 1.27 mm/s (0.05 in/s).
struct MachineForce {
  double effective_mass = 0;       ///< m_e [kg]. The paper prints the weight, 1 kN/g = 102 kg
  double coulomb_friction = 0;     ///< F_s [N]
  double viscous_friction = 0;     ///< F_d [N·(s/m)^α]
  double exponent = 1;             ///< α [-]
  double offset = 0;               ///< d [N]
  double rest_velocity = 1.27e-3;  ///< below it there is no friction [m/s]

  /// @param velocity [m/s] @param acceleration [m/s²] @returns F [N]   @realtime
  [[nodiscard]] double operator()(double velocity, double acceleration) const RTHS_REALTIME;
};

/// Table 2 of the paper, long and lat: the machine set up for the Unison and EQS bearings, and for
/// the EPS bearing. Offsets are not printed there and are zero here.
struct MachineSetup {
  MachineForce long_axis, lat_axis;
};
[[nodiscard]] MachineSetup unison_eqs_setup();
[[nodiscard]] MachineSetup eps_setup();

/// Subtracts the machine's own force from the measured force, sample by sample. Uses measured
/// signals only: the velocity is the causal slope of the measured displacement.
class ForceObserver {
 public:
  /// @param period  of the samples [s]
  /// @param slope_length  samples of displacement in the slope   @setup
  ForceObserver(const MachineForce& machine, double period, int slope_length = 32);
  /// @param displacement [m], acceleration [m/s²], force [N]: measured in one sample
  /// @returns the specimen's force [N]   @realtime
  [[nodiscard]] double step(double displacement, double acceleration, double force) RTHS_REALTIME;
  [[nodiscard]] double velocity() const { return velocity_; }            ///< [m/s]
  [[nodiscard]] double machine_force() const { return machine_force_; }  ///< [N]

 private:
  MachineForce machine_;
  EndSlope slope_;
  double velocity_ = 0;
  double machine_force_ = 0;
};

/// The machine's force identified from a run with an empty table.
struct ForceIdentification {
  MachineForce machine;
  /// Half widths of the 95 % intervals of m_e, F_s, F_d and d, in their units.
  double effective_mass_95 = 0, coulomb_friction_95 = 0, viscous_friction_95 = 0, offset_95 = 0;
  double residual_rms = 0;  ///< [N]
};

/// Least squares for m_e, F_s, F_d ≥ 0 and d, with α given, over a run with an empty table. Samples
/// slower than 3 % of the run's largest speed are left out: their friction's sign is uncertain.
/// @param displacement [m], acceleration [m/s²], force [N]: equally long, as measured
/// @param period  of the samples [s]
/// @throws Error if they differ in length, are too few, or do not excite all four terms   @setup
[[nodiscard]] ForceIdentification identify_machine_force(std::span<const double> displacement,
                                                         std::span<const double> acceleration,
                                                         std::span<const double> force,
                                                         double period, double exponent = 1,
                                                         int slope_length = 32);

}  // namespace rths::controller
