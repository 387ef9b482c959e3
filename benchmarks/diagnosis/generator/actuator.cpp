// SPDX-License-Identifier: Apache-2.0
#include "actuator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trial {
namespace {

constexpr double kLongestDelay = 0.05;  ///< [s]
constexpr double kYieldingBandwidth =
    2 * std::numbers::pi * 50;  ///< of a spring under load [rad/s]

double beyond(double error, double band) { return error - std::clamp(error, -band, band); }

}  // namespace

Actuator::Actuator(const Physics& physics, double step)
    : physics_(physics),
      step_(step),
      frequency_(2 * std::numbers::pi * kActuatorFrequency * physics[kBandwidth]),
      sent_(static_cast<std::size_t>(kLongestDelay / step) + 2) {}

Plane Actuator::delayed(const Plane& command) {
  newest_ = (newest_ + 1) % sent_.size();
  sent_[newest_] = command;
  const double age = (kTransportDelay - kSampleTime + physics_[kExtraDelay]) / step_;
  const double whole = std::floor(age);
  const std::size_t steps = static_cast<std::size_t>(whole);
  const Plane& later = sent_[(newest_ + sent_.size() - steps) % sent_.size()];
  const Plane& earlier = sent_[(newest_ + sent_.size() - steps - 1) % sent_.size()];
  const double share = age - whole;
  return {later[0] + share * (earlier[0] - later[0]), later[1] + share * (earlier[1] - later[1])};
}

double Actuator::servo(const Lag& piston, double command) const {
  return frequency_ * frequency_ * beyond(command - piston.value, physics_[kDeadBand]) -
         2 * kActuatorDamping * frequency_ * piston.rate;
}

void Actuator::advance_piston(Lag& piston, double before, double command) const {
  const double first = servo(piston, before);
  const Lag ahead{piston.value + step_ * piston.rate, piston.rate + step_ * first, 0};
  const double second = servo(ahead, command);
  const double limit = physics_[kSpeedLimit];
  const double wanted = piston.rate + 0.5 * step_ * (first + second);
  const double rate = std::clamp(wanted, -limit, limit);
  piston.value += 0.5 * step_ * (piston.rate + rate);
  piston.acceleration = (rate - piston.rate) / step_;
  piston.rate = rate;
}

// T² y'' + 2 ζ T y' + y = x
void Actuator::advance_oil(Lag& oil, const Lag& piston) const {
  const double T = physics_[kOilTime];
  if (T <= 0) {
    oil = piston;
    return;
  }
  const auto bend = [&](double value, double rate) {
    return (piston.value - value) / (T * T) - 2 * physics_[kOilDamping] * rate / T;
  };
  const double first = bend(oil.value, oil.rate);
  const double second = bend(oil.value + step_ * oil.rate, oil.rate + step_ * first);
  const double rate = oil.rate + 0.5 * step_ * (first + second);
  oil.value += 0.5 * step_ * (oil.rate + rate);
  oil.acceleration = (rate - oil.rate) / step_;
  oil.rate = rate;
}

// The spring between piston and platen deforms under the load and the platen's inertia force:
//     s = χ F,  F = load + m (a - s''),  through a critically damped lag.
void Actuator::advance_yielding(std::size_t axis, double acceleration, double load) {
  const double compliance = physics_[kCompliance];
  Lag& yielding = yielding_[axis];
  if (compliance <= 0) return;
  const double mass = kPlatenMass[axis] * (1 + physics_[kMassErrorX + axis]);
  const double square = kYieldingBandwidth * kYieldingBandwidth;
  const double force = load + mass * acceleration;
  yielding.acceleration =
      (square * (compliance * force - yielding.value) - 2 * kYieldingBandwidth * yielding.rate) /
      (1 + square * compliance * mass);
  yielding.rate += step_ * yielding.acceleration;
  yielding.value += step_ * yielding.rate;
}

void Actuator::advance(const Plane& command, const Plane& load) {
  const Plane before = reference_;
  reference_ = delayed(command);
  for (std::size_t i = 0; i < 2; ++i) {
    advance_piston(piston_[i], before[i], reference_[i]);
    advance_oil(oil_[i], piston_[i]);
    advance_yielding(i, oil_[i].acceleration, load[i]);
    platen_.displacement[i] = oil_[i].value - yielding_[i].value;
    platen_.velocity[i] = oil_[i].rate - yielding_[i].rate;
    platen_.acceleration[i] = oil_[i].acceleration - yielding_[i].acceleration;
  }
}

}  // namespace trial
