// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <rths/controller/force_observer.hpp>

namespace rths::controller {

/// One axis of a test machine that moves without a specimen: equally long, as measured.
struct EmptyTableRecord {
  double period = 0.001;             ///< of the samples [s]
  std::vector<double> displacement;  ///< [m]
  std::vector<double> acceleration;  ///< [m/s²]
  std::vector<double> force;         ///< of the load cells [N]
  std::vector<double> load;          ///< vertical load on the guides [N]; empty: not measured
};

/// A value and the half width of its 95 % interval, in the same unit.
struct Estimate {
  double value = 0, half_width = 0;
};

/// The force of a machine without a specimen:
///     F = m_e a(t + τ_a) + (F_s + μ N) sign(v) + F_d v + d
struct EmptyTableFit {
  Estimate effective_mass;      ///< m_e [kg]
  Estimate coulomb_friction;    ///< F_s [N], ≥ 0
  Estimate load_coefficient;    ///< μ [-], ≥ 0; 0 if the load does not vary
  Estimate viscous_friction;    ///< F_d [N·s/m], ≥ 0
  Estimate offset;              ///< d [N]
  Estimate acceleration_delay;  ///< τ_a: of the accelerometer behind the load cells [s]
  bool load_varies = false;     ///< μ was identified, else F_s contains μ N
  double mean_load = 0;         ///< of the fitted samples [N]
  double largest_speed = 0, largest_acceleration = 0;  ///< in the records [m/s], [m/s²]
  /// Residual of the fitted samples, smoothed as they are [N].
  double residual_rms = 0, residual_peak = 0;
  /// Measured less fitted force, sample by sample, reversals included [N].
  double raw_rms = 0, raw_peak = 0;
  /// Correlation of neighbouring fitted samples of the residual [-]; 0 if it is white.
  double neighbour_correlation = 0;
  /// Share of the first 20 correlations that exceed the 95 % bound of white noise [-]; 0.05 if it
  /// is white.
  double correlated_share = 0;

  /// As the force observer takes it, under a vertical load [N].
  [[nodiscard]] MachineForce machine(double load) const;
};

/// Least squares over all records together. All signals are smoothed alike, so that noise of the
/// accelerometer does not bias the mass; samples near a reversal, where the sign of a noisy
/// velocity is uncertain, are left out. The intervals allow for a residual that is correlated in
/// time.
/// @throws Error if signals differ in length, or the records do not excite inertia and friction
/// @setup
[[nodiscard]] EmptyTableFit identify_empty_table(std::span<const EmptyTableRecord> records);

}  // namespace rths::controller
