// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/inverse_lead.hpp>

#include <algorithm>
#include <cmath>

#include <rths/core/require.hpp>

namespace rths::controller {
namespace {

constexpr Require kRequireLead{"adaptive inverse"};
constexpr double kLargestLoadShare = 0.8;  // of the force capacity
constexpr double kSettlingDelays = 3;      // delays of the smoothing until it has forgotten a kink
constexpr double kFade = 0.04;             // back to the smoothed derivatives [s]

enum Coefficient {
  kPosition,
  kVelocity,
  kAcceleration,
  kJerk,
  kLoad,
  kLoadRate,
  kDeadBand,
  kFlowLoss
};

InverseLeadSettings checked(InverseLeadSettings s) {
  kRequireLead.positive("sign_velocity", s.sign_velocity);
  kRequireLead.positive("force_capacity", s.force_capacity);
  kRequireLead.positive("largest_reference", s.largest_reference);
  kRequireLead(s.effective_mass >= 0, "effective_mass", s.effective_mass, "0 or more");
  return s;
}

}  // namespace

InverseLead::Terms InverseLead::vector_of(const InverseCoefficients& c) {
  Terms terms;
  terms << c.a0, c.a1, c.a2, c.a3, c.load, c.load_rate, c.dead_band, c.flow_loss;
  return terms;
}

InverseCoefficients InverseLead::coefficients_of(const Terms& w) {
  return {w[kPosition], w[kVelocity], w[kAcceleration], w[kJerk],
          w[kLoad],     w[kLoadRate], w[kDeadBand],     w[kFlowLoss]};
}

InverseLead::InverseLead(const InverseLeadSettings& settings)
    : settings_{checked(settings)},
      smoothing_{{settings.period, settings.smoothing, settings.average, settings.oil_column}},
      force_rate_{settings.force_slope, settings.period} {}

void InverseLead::follow_pace(bool is_slowed) noexcept {
  if (is_slowed)
    settling_ = std::lround(kSettlingDelays * smoothing_.delay() / settings_.period);
  else if (settling_ > 0)
    --settling_;
  slowed_ = settling_ > 0 ? 1 : std::max(0.0, slowed_ - settings_.period / kFade);
}

void InverseLead::advance(double target, double force, const CommandRates& rates) noexcept {
  const double bounded = std::clamp(force, -settings_.force_capacity, settings_.force_capacity);
  follow_pace(rates.is_slowed);
  smoothing_.advance(target);
  const TargetSmoothing::Derivatives& smoothed = smoothing_.smoothed();
  TargetSmoothing::Derivatives sharp = smoothing_.sharp();
  target_ = target;
  fourth_derivative_ = (1 - slowed_) * smoothed[4];
  // The target's motion one lead time after now, from the smoothed one.
  const double delay = smoothing_.delay();
  double jerk = smoothed[3], acceleration = smoothed[2] + delay * smoothed[3];
  double velocity = smoothed[1] + delay * (smoothed[2] + delay / 2 * smoothed[3]);
  if (slowed_ > 0) {
    const TargetSmoothing::Derivatives known{target, rates.velocity, rates.acceleration, 0, 0};
    sharp += slowed_ * (known - sharp);
    velocity += slowed_ * (rates.velocity - velocity);
    acceleration += slowed_ * (rates.acceleration - acceleration);
    jerk *= 1 - slowed_;
  }
  velocity += settings_.lead_time * acceleration;
  const double force_rate = force_rate_(bounded);
  const double total = bounded + settings_.lead_time * force_rate +
                       settings_.effective_mass * (acceleration + settings_.lead_time * jerk);
  const double used = std::clamp(std::copysign(total, velocity * total) / settings_.force_capacity,
                                 -kLargestLoadShare, kLargestLoadShare);
  terms_ << sharp.head<4>(), bounded, force_rate, std::tanh(velocity / settings_.sign_velocity),
      velocity * (1 / std::sqrt(1 - used) - 1);
}

double InverseLead::reference(const Terms& w, double share) noexcept {
  const double load = w[kLoad] * terms_[kLoad] + w[kLoadRate] * terms_[kLoadRate];
  const double lead = w.head<kLoad>().dot(terms_.head<kLoad>()) +
                      settings_.a4 * fourth_derivative_ + w[kDeadBand] * terms_[kDeadBand] +
                      w[kFlowLoss] * terms_[kFlowLoss] +
                      std::clamp(load, -settings_.largest_load_lead, settings_.largest_load_lead);
  const double wanted = (1 - share) * target_ + share * lead;
  const double clipped =
      std::clamp(wanted, -settings_.largest_reference, settings_.largest_reference);
  is_clipped_ = clipped != wanted || std::abs(load) > settings_.largest_load_lead;
  return clipped;
}

}  // namespace rths::controller
