// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/sim/test_machine.hpp>

namespace rths::sim {

/// Signals of one axis of a machine, equally long, one sample per period.
struct TransferRecord {
  double period = 0.001;             ///< [s]
  std::vector<double> reference;     ///< sent to the machine and held for the period before [m]
  std::vector<double> displacement;  ///< measured at the end of the period [m]
  std::vector<double> force;         ///< of the actuator, measured at the same instant [N]
  std::vector<double> acceleration;  ///< measured at the same instant; may be empty [m/s²]
};

/// A parameter of an identified transfer system.
struct TransferParameter {
  std::string name, unit;
  double value = 0;
  double half_width = 0;  ///< of the 95 % interval; NaN: the record does not determine it
};

/// The transfer system of one axis, from reference to displacement, as a servo-hydraulic axis:
///
///     demand       e = K (r(t − τ) − x) − κ (F − F_f),  Ḟ_f = ω_f (F − F_f)
///     valve        s̈ = ω² (e − s) − 2 ζ ω ṡ
///     flow         y = s − clip(s, δ K);  q = y √(1 − sgn(y) F/F_s)
///     oil column   ẋ = q − l F − c Ḟ
///
/// F_f is the slow force that the valve's feedback leaves out; F_f = 0 if ω_f = 0.
/// F is the measured force, so neither specimen nor platen enters. Source: Merritt (1967).
struct AxisTransfer {
  double gain = 20;              ///< K [1/s]
  double transport_delay = 0;    ///< τ [s]
  double valve_frequency = 15;   ///< ω/2π [Hz]
  double valve_damping = 0.7;    ///< ζ [-]
  double dead_band = 0;          ///< δ, as an error of position [m]
  double pressure_feedback = 0;  ///< κ [m/(s·N)]
  double pressure_washout = 0;   ///< ω_f/2π [Hz]
  double compliance = 1e-9;      ///< c [m/N]
  double supply_force = 1e7;     ///< F_s [N]
  double leakage = 0;            ///< l [m/(s·N)]

  std::vector<TransferParameter> parameters;  ///< the values above, with intervals
  /// RMS of measured less predicted displacement on the scored half of the record, over the RMS of
  /// the displacement [-]: of this model, and of a displacement equal to the reference.
  double error = 0, error_without = 0;
  /// Share of the scored windows of two seconds in which this model predicts the displacement
  /// better than the reference does [-].
  double confidence = 0;
  double residual = 0;  ///< RMS of measured less predicted displacement there [m]

  /// Delay of slow motion, 1/K + τ [s]. The valve is inside the loop: its lag changes the delay of
  /// fast motion only.
  [[nodiscard]] double delay() const;
};

/// Displacement of a transfer system at rest at first, under the reference and force of a record
/// [m].   @setup
[[nodiscard]] std::vector<double> predicted(const AxisTransfer& system,
                                            const TransferRecord& record);

/// A servo-hydraulic axis that moves like a transfer system. Its valve saturates at no velocity
/// that the axis can reach.
/// @param axis  limits, supply pressure, mass and offset   @setup
[[nodiscard]] ServoAxis servo_axis(const AxisTransfer& system, ServoAxis axis);

}  // namespace rths::sim
