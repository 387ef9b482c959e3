// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/vertical_force.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rths/core/error.hpp>

namespace rths::controller {

ForceCascade::ForceCascade(const ForceCascadeSettings& settings) : settings_{settings} {
  if (!(settings.period > 0 && settings.stiffness > 0 && settings.gain > 0 && settings.lag >= 0 &&
        settings.reference_limit > 0))
    throw Error{"force cascade: expected positive period, stiffness, gain and limit"};
}

double ForceCascade::step(double target, double measured) noexcept {
  if (!std::isfinite(target) || !std::isfinite(measured)) return reference_;
  const double error = (target - measured) / settings_.stiffness;
  integral_ = std::clamp(integral_ + settings_.gain * settings_.period * error,
                         -settings_.reference_limit, settings_.reference_limit);
  reference_ = target / settings_.stiffness + integral_ + settings_.gain * settings_.lag * error;
  return reference_;
}

double AxialBearing::displacement(double force, double horizontal) const noexcept {
  const double square = horizontal * horizontal;
  double flexibility = (1 + softening * square) / stiffness + 1 / servo_stiffness;
  if (series_stiffness > 0) flexibility += 1 / series_stiffness;
  return force * flexibility + (lift_radius != 0 ? square / (2 * lift_radius) : 0);
}

VerticalForceSettings srmd_vertical() {
  VerticalForceSettings settings;
  AdaptiveInverseSettings& inverse = settings.inverse;
  // Position loop of 20.5/s, spool of 20 Hz with ratio 0.8, 2 ms of transport and half a period of
  // hold: (1 + s(1 + 2ζ/ω s + s²/ω²)/K_v) e^(2.5 ms s), up to the fourth order.
  inverse.initial = {1, 0.0513, 7.45e-4, 4.8e-6, 0, 0, 7e-5, 0.0488};
  inverse.uncertainty = {0.1, 0.005, 1e-4, 5e-7, 0, 0, 1e-4, 0.01};
  inverse.a4 = 9.6e-9;
  inverse.lead_time = 0.015;
  inverse.sign_velocity = 2e-3;
  inverse.force_capacity = 53.4e6;
  inverse.effective_mass = 0;
  inverse.smoothing = 1e-3;
  inverse.cutoff = 25;
  inverse.error = 5e-5;
  inverse.informative_speed = 2e-3;
  inverse.largest_error = 2e-3;
  inverse.largest_reference = 0.127;
  settings.observer_bandwidth = 8;
  return settings;
}

VerticalForceControl::VerticalForceControl(const VerticalForceSettings& settings)
    : settings_{settings}, inverse_{settings.inverse} {
  if (!(settings.bearing.stiffness > 0 && settings.bearing.servo_stiffness > 0 &&
        settings.bearing.softening >= 0 && settings.bearing.series_stiffness >= 0))
    throw Error{"vertical force: expected positive stiffnesses of bearing and servo"};
  if (!(settings.observer_bandwidth >= 0 && settings.observer_limit > 0))
    throw Error{"vertical force: expected a bandwidth of 0 or more and a positive limit"};
}

double VerticalForceControl::step(double target, double measured, double horizontal_target,
                                  double horizontal, bool adapt) noexcept {
  const double wanted = settings_.bearing.displacement(target, horizontal_target);
  const double found = settings_.bearing.displacement(measured, horizontal);
  const double error = found - wanted;
  if (std::isfinite(error) && std::abs(error) < settings_.inverse.largest_error) {
    const double rate =
        2 * std::numbers::pi * settings_.observer_bandwidth * settings_.inverse.period;
    disturbance_ = std::clamp(disturbance_ + rate * error, -settings_.observer_limit,
                              settings_.observer_limit);
  }
  return inverse_.step(wanted - disturbance_, found, target, 1, adapt);
}

}  // namespace rths::controller
