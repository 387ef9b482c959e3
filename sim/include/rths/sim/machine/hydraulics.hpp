// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/realtime.hpp>

namespace rths::sim::machine {

/// A servo-hydraulic actuator: spool loop, valve, oil and displacement loop.
///
///     servo   w = (K_v (s_ref − s) + k_f ṡ_ref)/v_r − K_p (P − P_f)/P_0          |w| ≤ 1
///     spool   ṗ = ω_p (K_i (w − x) − p),   ẋ = p,   |p| ≤ slew,   |x| ≤ 1
///             K_i = ω/(2ζ),  ω_p = 2ζω: without limits a spool of frequency ω and damping ζ
///     valve   y = sign(x) max(0, |x| − d) / (1 − d),   Q = A v_r y √(ΔP/P_0) / √(1 + (y/y_s)²)
///     oil     Ṗ = B (1/V₁ + 1/V₂)(Q − A ṡ − C_l P)
///
/// d: dead band (overlap); y_s: flow saturation; P: load pressure; P_f: its slow part, which a
/// washout removes from the feedback. A double-acting cylinder has ΔP = P_s − sign(y) P. A
/// single-acting one (vertical) has one chamber, with ΔP = P_s − P inwards and P outwards. P_0 is
/// the nominal, P_s the present supply pressure. Sources: Merritt (1967) for valve and oil; the
/// saturation is that of the actuator model in OpenFresco.
struct Actuator {
  double piston_area = 0.215;    ///< A [m²]
  double stroke = 1.3;           ///< to either side of mid-stroke [m]
  double dead_length = 0.15;     ///< oil beyond the stroke, per chamber [m]
  double rated_velocity = 2;     ///< v_r: valve open, P = 0 [m/s]
  double flow_saturation = 4;    ///< y_s [-]
  double dead_band = 0.01;       ///< d [-]
  double valve_frequency = 12;   ///< ω/2π [Hz]
  double valve_damping = 0.8;    ///< ζ [-]
  double spool_slew = 30;        ///< [1/s]
  double leakage = 1e-10;        ///< C_l [m³/(s·Pa)]
  double position_gain = 18;     ///< K_v [1/s]
  double pressure_gain = 0;      ///< K_p [-]
  double pressure_washout = 1;   ///< corner of the washout [Hz]
  double cushion_length = 0.05;  ///< the ports close over this distance before the stop [m]
  bool single_acting = false;
};

struct ActuatorState {
  double pilot = 0;          ///< p: commanded rate of the spool [1/s]
  double spool = 0;          ///< x [-]
  double pressure = 0;       ///< P [Pa]
  double slow_pressure = 0;  ///< P_f [Pa]
};

/// Motion and reference of an actuator, measured from mid-stroke.
struct ActuatorMotion {
  double displacement = 0, velocity = 0;         ///< s [m], ṡ [m/s]
  double reference = 0, reference_velocity = 0;  ///< s_ref [m], ṡ_ref [m/s]
  double feed_forward = 0;                       ///< k_f [-]
};

struct Supply {
  double pressure = 20.7e6;      ///< P_0 [Pa]
  double bulk_modulus = 1.2e9;   ///< B [Pa]
  double gas_volume = 4;         ///< of the accumulators at P_0 [m³]
  double gas_exponent = 1.4;     ///< n of P Vⁿ [-]
  double pump_flow = 0.05;       ///< largest [m³/s]
  double pump_pressure = 0.5e6;  ///< the pump delivers fully this far below P_0 [Pa]

  /// P_s = P_0 (V_0/V)ⁿ [Pa]   @realtime
  [[nodiscard]] double pressure_at(double gas) const RTHS_REALTIME;
  /// V̇ of the gas: flow drawn less the pump's [m³/s]   @realtime
  [[nodiscard]] double gas_rate(double pressure_now, double drawn) const RTHS_REALTIME;
};

/// Valve opening y with overlap [-].   @realtime
[[nodiscard]] double valve_opening(const Actuator& actuator, double spool) RTHS_REALTIME;
/// Flow into the actuator [m³/s].   @realtime
[[nodiscard]] double valve_flow(const Actuator& actuator, const Supply& supply, double spool,
                                double pressure, double supply_pressure) RTHS_REALTIME;
/// Stiffness of the oil column at a displacement from mid-stroke, valve closed [N/m].   @realtime
[[nodiscard]] double oil_stiffness(const Actuator& actuator, const Supply& supply,
                                   double displacement) RTHS_REALTIME;

struct ActuatorRates {
  ActuatorState rates;
  double drawn = 0;  ///< flow from the supply [m³/s]
};
/// @param supply_pressure  present one [Pa]   @realtime
[[nodiscard]] ActuatorRates rates(const Actuator& actuator, const Supply& supply,
                                  const ActuatorState& state, const ActuatorMotion& motion,
                                  double supply_pressure) RTHS_REALTIME;
/// Mechanical stops of the spool, and relief valves and cavitation of the oil.   @realtime
void apply_limits(const Actuator& actuator, double supply_pressure,
                  ActuatorState& state) RTHS_REALTIME;

}  // namespace rths::sim::machine
