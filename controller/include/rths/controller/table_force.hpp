// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// A test machine's own force along one axis, with the effects that equation 1 of the paper omits:
///     F(t) = m_e a(t) + (F_s + μ N) z + F_d v + d,    dz/dx = (1 − z sign v)/δ
///     measured acceleration = a(t − τ_a)
/// z, between −1 and 1, is the friction's state: it follows the sign of the velocity over the
/// presliding length δ (Dahl 1968, the quasi-static limit of LuGre). N: axial load on the guides.
struct TableForce {
  double effective_mass = 0;       ///< m_e [kg]
  double coulomb_friction = 0;     ///< F_s [N]
  double load_friction = 0;        ///< μ [-]
  double viscous_friction = 0;     ///< F_d [N·s/m]
  double offset = 0;               ///< d [N]
  double presliding = 1e-3;        ///< δ [m], > 0
  double accelerometer_delay = 0;  ///< τ_a behind the load cells [s], 0 to 20 ms
  double displacement_lead = 0;    ///< of the displacement transducer before the load cells [s]
};

/// One instant of measured signals.
struct TableSample {
  double displacement = 0;  ///< [m]
  double acceleration = 0;  ///< [m/s²]
  double force = 0;         ///< of the load cells [N]
  double axial_load = 0;    ///< N [N]
};

struct TableObserverSettings {
  double period = 1e-3;           ///< of the samples [s]
  double velocity_bandwidth = 1;  ///< below it the velocity follows the displacement, above it the
                                  ///< integrated acceleration [Hz]
  double cutoff = 0;              ///< of a low-pass of second order on the result [Hz]; 0: none
};

class TableSignals;

/// Subtracts the machine's own force from the measured force, sample by sample.
///
/// Force, displacement and load wait for the accelerometer, so that all belong to one instant. The
/// velocity comes from displacement and acceleration together, without lag.
class TableForceObserver {
 public:
  /// @throws Error if a value is out of range   @setup
  TableForceObserver(const TableForce& machine, const TableObserverSettings& settings);
  ~TableForceObserver();
  TableForceObserver(TableForceObserver&&) noexcept;

  /// A sample with a value that is not finite counts as a repetition of the last good one.
  /// @returns the specimen's force, `lag` ago [N]   @realtime
  [[nodiscard]] double step(const TableSample& sample) RTHS_REALTIME;
  /// Measured displacement as late as the accelerometer, like the force [m]
  [[nodiscard]] double displacement() const { return displacement_; }
  [[nodiscard]] double velocity() const { return velocity_; }            ///< [m/s]
  [[nodiscard]] double machine_force() const { return machine_force_; }  ///< [N]
  [[nodiscard]] long bad_samples() const { return bad_samples_; }
  /// Age of the result at low frequencies: accelerometer and low-pass [s].
  [[nodiscard]] double lag() const { return lag_; }

 private:
  TableForce machine_;
  std::unique_ptr<TableSignals> signals_;
  TableSample last_;
  double displacement_ = 0, velocity_ = 0, machine_force_ = 0, lag_ = 0;
  long bad_samples_ = 0;
};

/// The signals of a run with an empty table: equally long, one value per sample.
struct TableRecording {
  std::span<const double> displacement;  ///< [m]
  std::span<const double> acceleration;  ///< [m/s²]
  std::span<const double> force;         ///< [N]
  std::span<const double> axial_load;    ///< [N]; empty: not measured, μ is then zero
};

struct TableIdentificationSettings {
  double period = 1e-3;           ///< of the samples [s]
  double velocity_bandwidth = 1;  ///< as the observer's [Hz]
  double cutoff = 25;             ///< of the low-pass on both sides of the equation [Hz]
};

/// The machine's force identified from runs with an empty table.
struct TableIdentification {
  TableForce machine;
  TableForce half_width;           ///< of the 95 % intervals; 0 of a value that was not identified
  bool has_load_friction = false;  ///< the axial load varied enough to tell μ from F_s
  double residual_rms = 0;         ///< below the cut-off [N]
  double residual_peak = 0;        ///< [N]
  double sample_rms = 0, sample_peak = 0;  ///< residual of every sample in motion [N]
  /// Correlation of neighbouring means of 40 ms of the residual [-]; 0 if it is white.
  double neighbour_correlation = 0;
  /// Share of the first 20 correlations beyond the 95 % bound of white noise [-]; 0.05 if white.
  double correlated_share = 0;
  double largest_speed = 0;  ///< [m/s]
  double mean_load = 0;      ///< of the samples in motion [N]
  int iterations = 0;
};

/// Least squares over runs with an empty table, harmonic or earthquake, of one set-up of the
/// machine. Linear in m_e, F_s, μ, F_d, d; Gauss-Newton in τ_a and δ. Rows at rest are left out. A
/// negative friction coefficient becomes 0; its interval reaches to the upper end of the free fit.
/// The intervals allow for the correlation of the residual (Newey & West 1987). The lead of the
/// displacement follows from the delay of the acceleration behind the second derivative of the
/// displacement, below 8 Hz.
/// @throws Error if a run's signals differ in length, are too short or not finite, or do not excite
///         inertia and friction   @setup
[[nodiscard]] TableIdentification identify_table_force(std::span<const TableRecording> runs,
                                                       const TableIdentificationSettings& settings);

}  // namespace rths::controller
