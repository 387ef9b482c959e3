// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/inverse_lead.hpp>

#include <algorithm>
#include <cmath>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr Require kRequireLead{"adaptive inverse"};
constexpr double kLargestLoadShare = 0.8;  // of the force capacity

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
      clock_smoothing_{smoothing_},
      force_slope_{settings.force_slope, settings.period} {}

void InverseLead::advance(double target, double force, const Pace& pace) noexcept {
  const double bounded = std::clamp(force, -settings_.force_capacity, settings_.force_capacity);
  const double on_path = target - pace.in_clock;
  if (const auto sample = targets_(on_path, pace.share)) smoothing_.advance(*sample);
  clock_smoothing_.advance(pace.in_clock);
  const TargetSmoothing::Derivatives smoothed =
      pace.lead * smoothing_.smoothed_after(targets_.since() * settings_.period) +
      clock_smoothing_.smoothed();
  TargetSmoothing::Derivatives sharp = smoothing_.sharpened(smoothed);
  sharp[0] += (1 - pace.lead) * on_path;
  sharp.tail<TargetSmoothing::kDerivatives - 2>() *= pace.curvature;
  target_ = target;
  fourth_derivative_ = pace.curvature * smoothed[4];
  // The target's motion one lead time after now, from the smoothed one.
  const double delay = smoothing_.delay();
  const double jerk = pace.curvature * smoothed[3];
  const double acceleration = pace.curvature * smoothed[2] + delay * jerk;
  const double velocity = smoothed[1] + delay * (smoothed[2] + delay / 2 * smoothed[3]) +
                          settings_.lead_time * acceleration;
  if (const auto sample = forces_(bounded, pace.force_share)) force_rate_ = force_slope_(*sample);
  const double force_rate = pace.curvature * force_rate_;
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
