// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/machine/hydraulics.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rths::sim::machine {
namespace {

double signed_root(double x) { return std::copysign(std::sqrt(std::abs(x)), x); }

// Near its stop, the piston closes the port through which oil leaves.
double cushion(const Actuator& a, double displacement, double flow) {
  const double towards = std::copysign(displacement, displacement * flow);
  return std::clamp((a.stroke - towards) / a.cushion_length, 0.0, 1.0);
}

}  // namespace

double Supply::pressure_at(double gas) const noexcept {
  return pressure * std::pow(gas_volume / gas, gas_exponent);
}

double Supply::gas_rate(double pressure_now, double drawn) const noexcept {
  const double demand = std::clamp((pressure - pressure_now) / pump_pressure, 0.0, 1.0);
  return drawn - pump_flow * demand;
}

double valve_opening(const Actuator& a, double spool) noexcept {
  const double beyond = std::abs(spool) - a.dead_band;
  return beyond <= 0 ? 0 : std::copysign(beyond / (1 - a.dead_band), spool);
}

double valve_flow(const Actuator& a, const Supply& supply, double spool, double pressure,
                  double supply_pressure) noexcept {
  const double y = valve_opening(a, spool);
  const double double_acting = supply_pressure - std::copysign(pressure, y * pressure);
  const double single_acting = y > 0 ? supply_pressure - pressure : pressure;
  const double drop = a.single_acting ? single_acting : double_acting;
  const double saturation = y / a.flow_saturation;
  return a.piston_area * a.rated_velocity * y * signed_root(drop / supply.pressure) /
         std::sqrt(1 + saturation * saturation);
}

double oil_stiffness(const Actuator& a, const Supply& supply, double displacement) noexcept {
  const double half = a.stroke + a.dead_length;
  const double x = std::clamp(displacement, -a.stroke, a.stroke);
  const double inverse = a.single_acting ? 1 / (half + x) : 1 / (half + x) + 1 / (half - x);
  return supply.bulk_modulus * a.piston_area * inverse;
}

ActuatorRates rates(const Actuator& a, const Supply& supply, const ActuatorState& s,
                    const ActuatorMotion& m, double supply_pressure) noexcept {
  const double velocity_demand =
      a.position_gain * (m.reference - m.displacement) + m.feed_forward * m.reference_velocity;
  const double damping = a.pressure_gain * (s.pressure - s.slow_pressure) / supply.pressure;
  const double demand = std::clamp(velocity_demand / a.rated_velocity - damping, -1.0, 1.0);
  const double omega = 2 * std::numbers::pi * a.valve_frequency;
  const double inner_gain = omega / (2 * a.valve_damping);
  double flow = valve_flow(a, supply, s.spool, s.pressure, supply_pressure);
  flow *= cushion(a, m.displacement, flow);
  ActuatorRates result;
  result.rates.pilot = 2 * a.valve_damping * omega * (inner_gain * (demand - s.spool) - s.pilot);
  result.rates.spool = std::clamp(s.pilot, -a.spool_slew, a.spool_slew);
  result.rates.pressure = oil_stiffness(a, supply, m.displacement) /
                          (a.piston_area * a.piston_area) *
                          (flow - a.piston_area * m.velocity - a.leakage * s.pressure);
  result.rates.slow_pressure =
      2 * std::numbers::pi * a.pressure_washout * (s.pressure - s.slow_pressure);
  result.drawn = a.single_acting ? std::max(0.0, flow) : std::abs(flow);
  return result;
}

void apply_limits(const Actuator& a, double supply_pressure, ActuatorState& s) noexcept {
  s.spool = std::clamp(s.spool, -1.0, 1.0);
  s.pressure = std::clamp(s.pressure, a.single_acting ? 0.0 : -supply_pressure, supply_pressure);
}

}  // namespace rths::sim::machine
