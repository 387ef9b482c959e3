// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/vertical_force.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>

namespace rths::controller {

ForceCascade::ForceCascade(const ForceCascadeSettings& settings) : settings_{settings} {
  const Require require{"force cascade"};
  require.positive("period", settings.period);
  require.positive("stiffness", settings.stiffness);
  require.positive("gain", settings.gain);
  require.zero_or_more("lag", settings.lag);
  require.positive("reference limit", settings.reference_limit);
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
  return force * flexibility + height_lost(horizontal);
}

double AxialBearing::height_lost(double horizontal) const noexcept {
  return lift_radius != 0 ? horizontal * horizontal / (2 * lift_radius) : 0;
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

namespace {

constexpr double kLeastPressure = 0.05;  // share of the supply's that moves the oil
// Of the lead of a force that waits: the machine would pass its target within the lag of 50 ms [s].
constexpr double kLeadFade = 0.01;

// D(s) = Σ dₖ sᵏ of a servo, up to the third order.
struct Lead {
  double d1, d2, d3;
};
Lead lead_of(const SingleActingServo& servo) {
  const double omega = 2 * std::numbers::pi * servo.valve_frequency;
  const double a = 2 * servo.valve_damping / omega, b = 1 / (omega * omega), t = servo.delay;
  return {a + t, b + a * t + t * t / 2, b * t + a * t * t / 2 + t * t * t / 6};
}

double velocity_gain(const SingleActingServo& servo, double stiffness) {
  return (1 + stiffness / servo.oil_stiffness) / servo.position_gain;
}

}  // namespace

VerticalForceSettings single_acting_vertical(const AxialBearing& bearing,
                                             const SingleActingServo& servo,
                                             double servo_stiffness) {
  const Require require{"vertical force"};
  require.positive("position gain", servo.position_gain);
  require.positive("valve frequency", servo.valve_frequency);
  require.positive("valve damping", servo.valve_damping);
  require.zero_or_more("delay", servo.delay);
  require.positive("oil stiffness", servo.oil_stiffness);
  require.positive("supply force", servo.supply_force);
  require.zero_or_more("platen mass", servo.platen_mass);
  require.positive("servo stiffness", servo_stiffness);
  VerticalForceSettings settings = srmd_vertical();
  settings.bearing = bearing;
  // The loaded servo lags by force over stiffness, which no derivative of the motion contains.
  settings.bearing.servo_stiffness = std::numeric_limits<double>::infinity();
  settings.single_acting = servo;
  const Lead d = lead_of(servo);
  const double gain = velocity_gain(servo, bearing.stiffness), t = servo.delay;
  AdaptiveInverseSettings& inverse = settings.inverse;
  inverse.initial = {
      1,    t + gain, t * t / 2 + gain * d.d1, t * t * t / 6 + gain * d.d2, 1 / servo_stiffness, 0,
      3e-5, 0};
  inverse.uncertainty = {0.03, 0.005, 1e-4, 5e-7, 0.2 / servo_stiffness, 0, 3e-5, 0};
  inverse.a4 = gain * d.d3;
  // With 1 ms, a corner of the target moves the reference by up to 13 mm in a period.
  inverse.smoothing = 2e-3;
  inverse.force_capacity = servo.supply_force;
  inverse.error = 5e-4;
  settings.observer_bandwidth = 3;
  return settings;
}

FlowLead::FlowLead(const SingleActingServo& servo, double stiffness, double smoothing,
                   double period)
    : gain_{velocity_gain(servo, stiffness)},
      weight_{servo.platen_mass * kStandardGravity},
      supply_force_{servo.supply_force},
      smoothing_{smoothing},
      period_{period},
      on_path_{smoothing, period},
      in_clock_{smoothing, period} {
  // The poles delay by (1 + sT)ⁿ, which the lead includes.
  const Lead d = lead_of(servo);
  const double n = kPoles;
  first_ = d.d1 + n * smoothing;
  second_ = d.d2 + n * smoothing * d.d1 + n * (n - 1) / 2 * smoothing * smoothing;
}

// The velocity of the oil, this time after the last sample, by Taylor's series.
double FlowLead::ahead_in(const PoleChain<kPoles>& poles, double since) const noexcept {
  const double velocity = poles.difference(1) / smoothing_;
  const double acceleration = poles.difference(2) / (smoothing_ * smoothing_);
  const double jerk = poles.difference(3) / (smoothing_ * smoothing_ * smoothing_);
  return velocity + since * (acceleration + since / 2 * jerk) +
         first_ * (acceleration + since * jerk) + second_ * jerk;
}

double FlowLead::step(double wanted, double load, const Pace& pace) noexcept {
  if (const auto sample = targets_(wanted - pace.in_clock, pace.share)) on_path_.advance(*sample);
  in_clock_.advance(pace.in_clock);
  const double ahead =
      pace.lead * ahead_in(on_path_, targets_.since() * period_) + ahead_in(in_clock_, 0);
  const double used =
      std::clamp((load + weight_) / supply_force_, kLeastPressure, 1 - kLeastPressure);
  return gain_ * ahead * (1 / std::sqrt(ahead > 0 ? 1 - used : used) - 1);
}

VerticalForceControl::VerticalForceControl(const VerticalForceSettings& settings)
    : settings_{settings}, inverse_{settings.inverse} {
  if (settings.single_acting)
    flow_.emplace(*settings.single_acting, settings.bearing.stiffness, settings.inverse.smoothing,
                  settings.inverse.period);
  const Require require{"vertical force"};
  require.positive("stiffness of the bearing", settings.bearing.stiffness);
  require.positive("servo stiffness", settings.bearing.servo_stiffness);
  require.zero_or_more("softening of the bearing", settings.bearing.softening);
  require.zero_or_more("series stiffness", settings.bearing.series_stiffness);
  require.zero_or_more("observer bandwidth", settings.observer_bandwidth);
  require.positive("observer limit", settings.observer_limit);
}

double VerticalForceControl::step(double target, double measured, double horizontal_target,
                                  double horizontal, bool adapt, double path_share) noexcept {
  const double wanted = settings_.bearing.displacement(target, horizontal_target);
  const double found = settings_.bearing.displacement(measured, horizontal);
  const double error = found - wanted;
  if (std::isfinite(error) && std::abs(error) < settings_.inverse.largest_error) {
    const double rate =
        2 * std::numbers::pi * settings_.observer_bandwidth * settings_.inverse.period;
    disturbance_ = std::clamp(disturbance_ + rate * error, -settings_.observer_limit,
                              settings_.observer_limit);
  }
  if (std::isfinite(wanted)) last_wanted_ = wanted;
  if (std::isfinite(target)) last_target_ = target;
  const double height = settings_.bearing.height_lost(horizontal_target);
  if (std::isfinite(height)) last_height_ = height;
  const double fade = settings_.inverse.period / kLeadFade;
  lead_ += fade * (path_share * (1 - lead_) - (1 - path_share) * lead_);
  Pace pace{path_share, 1, path_share, last_height_ - disturbance_, lead_};
  const double reference = inverse_.step(wanted - disturbance_, found, target, 1, adapt, pace);
  pace.in_clock = last_height_;
  return reference + (flow_ ? flow_->step(last_wanted_, last_target_, pace) : 0);
}

}  // namespace rths::controller
