// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/adaptive_inverse.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr int kLearningFilterOrder = 2;
constexpr int kMachineSteps = 4;       // of the model G in a period
constexpr double kSolvePeriod = 0.05;  // [s]
constexpr double kBlend = 0.3;         // time constant towards new coefficients [s]
constexpr double kStart = 1.0;         // without learning: filters settle [s]
constexpr double kSpeedMemory = 1.0;   // of the RMS speed [s]
constexpr double kPause =
    0.3;  // without learning after a clipped or bad sample: G must forget it [s]
constexpr double kLargestChange = 4;       // of a coefficient, in standard deviations
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

using Terms = Eigen::Matrix<double, AdaptiveInverse::kTerms, 1>;

Terms vector_of(const InverseCoefficients& c) {
  Terms terms;
  terms << c.a0, c.a1, c.a2, c.a3, c.load, c.load_rate, c.dead_band, c.flow_loss;
  return terms;
}

AdaptiveInverseSettings checked(AdaptiveInverseSettings s) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0))
      throw Error{
          fmt::format("adaptive inverse: {} is {}, expected a positive number", name, value)};
  };
  positive("period", s.period);
  positive("smoothing", s.smoothing);
  positive("forgetting", s.forgetting);
  positive("error", s.error);
  positive("sign_velocity", s.sign_velocity);
  positive("force_capacity", s.force_capacity);
  positive("largest_reference", s.largest_reference);
  positive("largest_error", s.largest_error);
  positive("a0", s.initial.a0);
  positive("a1", s.initial.a1);
  positive("a2", s.initial.a2);
  positive("a3", s.initial.a3);
  if (s.initial.a1 * s.initial.a2 <= s.initial.a3 * s.initial.a0)
    throw Error{
        "adaptive inverse: the initial coefficients invert an unstable machine, expected a1 a2 > "
        "a0 a3"};
  if (s.initial.a3 / s.initial.a2 < s.period)
    throw Error{fmt::format("adaptive inverse: a3/a2 is {} s, expected at least the period of {} s",
                            s.initial.a3 / s.initial.a2, s.period)};
  if (!(vector_of(s.uncertainty).minCoeff() >= 0) || !vector_of(s.initial).allFinite())
    throw Error{
        "adaptive inverse: expected finite initial coefficients and uncertainties of 0 or more"};
  return s;
}

}  // namespace

AdaptiveInverse::AdaptiveInverse(const AdaptiveInverseSettings& settings)
    : settings_{checked(settings)},
      initial_{vector_of(settings.initial)},
      uncertainty_{vector_of(settings.uncertainty)},
      normal_{Eigen::Matrix<double, kTerms, kTerms>::Zero()},
      sharpening_{Eigen::Matrix<double, 5, kPoles + 1>::Zero()},
      poles_{settings.smoothing, settings.period},
      force_rate_{settings.force_slope, settings.period},
      filters_(kTerms + 1, LowPass{kLearningFilterOrder, settings.cutoff, settings.period}),
      error_filter_{kLearningFilterOrder, settings.cutoff, settings.period} {
  machine_.fill(Channels::Zero());
  // (1 + s T)^n undoes the smoothing; derivatives above the fourth are left out.
  for (int k = 0; k < 5; ++k) {
    double binomial = 1;
    for (int i = 0; k + i < 5; ++i) {
      sharpening_(k, k + i) = binomial * std::pow(settings.smoothing, i);
      binomial = binomial * (kPoles - i) / (i + 1);
    }
  }
}

InverseCoefficients AdaptiveInverse::coefficients() const {
  const Terms w = initial_ + change_;
  return {w[kPosition], w[kVelocity], w[kAcceleration], w[kJerk],
          w[kLoad],     w[kLoadRate], w[kDeadBand],     w[kFlowLoss]};
}

AdaptiveInverse::Derivatives AdaptiveInverse::smoothed_derivatives(double target) noexcept {
  poles_.advance(target);
  Derivatives derivatives;
  double scale = 1;
  for (int k = 0; k <= kPoles; ++k, scale /= settings_.smoothing)
    derivatives[k] = scale * poles_.difference(k);
  return derivatives;
}

AdaptiveInverse::Terms AdaptiveInverse::terms_of(const Derivatives& smoothed,
                                                 double force) noexcept {
  const Eigen::Matrix<double, 5, 1> target = sharpening_ * smoothed;
  fourth_derivative_ = smoothed[4];
  // The target's motion one lead time after now, from the smoothed one.
  const double delay = kPoles * settings_.smoothing;
  const double acceleration = smoothed[2] + delay * smoothed[3];
  const double velocity = smoothed[1] + delay * (smoothed[2] + delay / 2 * smoothed[3]) +
                          settings_.lead_time * acceleration;
  const double force_rate = force_rate_(force);
  const double total =
      force + settings_.lead_time * force_rate +
      settings_.effective_mass * (acceleration + settings_.lead_time * smoothed[3]);
  const double used = std::clamp(std::copysign(total, velocity * total) / settings_.force_capacity,
                                 -kLargestLoadShare, kLargestLoadShare);
  Terms terms;
  terms << target.head<4>(), force, force_rate, std::tanh(velocity / settings_.sign_velocity),
      velocity * (1 / std::sqrt(1 - used) - 1);
  return terms;
}

double AdaptiveInverse::sent(double target, const Terms& terms, double share) noexcept {
  const Terms w = initial_ + change_;
  const double load = w[kLoad] * terms[kLoad] + w[kLoadRate] * terms[kLoadRate];
  const double lead = w.head<kLoad>().dot(terms.head<kLoad>()) + settings_.a4 * fourth_derivative_ +
                      w[kDeadBand] * terms[kDeadBand] + w[kFlowLoss] * terms[kFlowLoss] +
                      std::clamp(load, -settings_.largest_load_lead, settings_.largest_load_lead);
  const double reference = (1 - share) * target + share * lead;
  const double clipped =
      std::clamp(reference, -settings_.largest_reference, settings_.largest_reference);
  if (clipped != reference || std::abs(load) > settings_.largest_load_lead) {
    ++clipped_;
    pause_ = std::lround(kPause / settings_.period);
  }
  return clipped;
}

bool AdaptiveInverse::is_informative(double speed, double error, bool is_good) noexcept {
  mean_square_speed_ += settings_.period / kSpeedMemory * (speed * speed - mean_square_speed_);
  if (!is_good) pause_ = std::lround(kPause / settings_.period);
  if (pause_ > 0) {
    --pause_;
    return false;
  }
  return static_cast<double>(tick_) * settings_.period > kStart &&
         std::abs(error) < settings_.largest_error &&
         mean_square_speed_ > settings_.informative_speed * settings_.informative_speed;
}

// Passes all terms and the change of the reference through G, then adds one row to the fit.
void AdaptiveInverse::learn(const Channels& sent_now, double error, bool is_good,
                            bool adapt) noexcept {
  const double h = settings_.period / kMachineSteps;
  const InverseCoefficients& a = settings_.initial;
  for (int k = 0; k < kMachineSteps; ++k) {
    machine_[2] +=
        h / a.a3 * (sent_now - a.a0 * machine_[0] - a.a1 * machine_[1] - a.a2 * machine_[2]);
    machine_[1] += h * machine_[2];
    machine_[0] += h * machine_[1];
  }
  Channels answer;
  for (int i = 0; i <= kTerms; ++i)
    answer[i] = filters_[static_cast<std::size_t>(i)](machine_[0][i]);
  const Terms regressors = answer.head<kTerms>();
  const double explained = answer[kTerms] - error_filter_(is_good ? error : 0);
  learning_ = is_informative(regressors[kVelocity], error, is_good) && adapt;
  if (!learning_) return;
  const double keep = 1 - settings_.period / settings_.forgetting;
  normal_ = keep * normal_ + regressors * regressors.transpose();
  right_side_ = keep * right_side_ + explained * regressors;
}

// In units of the standard deviations, so that the matrix is well conditioned and at least I.
void AdaptiveInverse::solve() noexcept {
  const double precision = 1 / (settings_.error * settings_.error);
  Eigen::Matrix<double, kTerms, kTerms> A =
      precision * uncertainty_.asDiagonal() * normal_ * uncertainty_.asDiagonal();
  A.diagonal().array() += 1;
  const Terms b = precision * uncertainty_.cwiseProduct(right_side_);
  const Terms scaled = A.ldlt().solve(b);
  if (!scaled.allFinite()) return;
  wanted_ = uncertainty_.cwiseProduct(scaled.cwiseMax(-kLargestChange).cwiseMin(kLargestChange));
}

double AdaptiveInverse::step(double target, double measured, double force, double share,
                             bool adapt) noexcept {
  const bool is_good = std::isfinite(target) && std::isfinite(measured) && std::isfinite(force);
  if (!is_good) ++bad_samples_;
  if (std::isfinite(target)) last_target_ = target;
  if (std::isfinite(measured)) last_measured_ = measured;
  if (std::isfinite(force))
    last_force_ = std::clamp(force, -settings_.force_capacity, settings_.force_capacity);

  const Terms terms = terms_of(smoothed_derivatives(last_target_), last_force_);
  const double reference = sent(last_target_, terms, share);
  Channels sent_now;
  sent_now << terms, reference - initial_.dot(terms) - settings_.a4 * fourth_derivative_;
  learn(sent_now, last_measured_ - last_target_, is_good, adapt);
  if (learning_ && tick_ % std::lround(kSolvePeriod / settings_.period) == 0) solve();
  if (adapt) change_ += settings_.period / kBlend * (wanted_ - change_);
  ++tick_;
  return reference;
}

}  // namespace rths::controller
