// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/adaptive_inverse.hpp>

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr Require kRequireInverse{"adaptive inverse"};

constexpr int kLearningFilterOrder = 2;
constexpr int kMachineSteps = 4;       // of the model G in a period
constexpr double kSolvePeriod = 0.05;  // [s]
constexpr double kBlend = 0.3;         // time constant towards new coefficients [s]
constexpr double kStart = 1.0;         // without learning: filters settle [s]
constexpr double kSpeedMemory = 1.0;   // of the RMS speed [s]
constexpr double kPause =
    0.3;  // without learning after a clipped, slow or bad sample: G must forget it [s]
constexpr double kLargestChange = 4;  // of a coefficient, in standard deviations
constexpr int kVelocityTerm = 1;

AdaptiveInverseSettings checked(AdaptiveInverseSettings s) {
  kRequireInverse.positive("forgetting", s.forgetting);
  kRequireInverse.positive("error", s.error);
  kRequireInverse.positive("largest_error", s.largest_error);
  kRequireInverse.positive("a0", s.initial.a0);
  kRequireInverse.positive("a1", s.initial.a1);
  kRequireInverse.positive("a2", s.initial.a2);
  kRequireInverse.positive("a3", s.initial.a3);
  if (s.initial.a1 * s.initial.a2 <= s.initial.a3 * s.initial.a0)
    throw Error{
        "adaptive inverse: the initial coefficients invert an unstable machine, expected a1 a2 > "
        "a0 a3"};
  if (s.initial.a3 / s.initial.a2 < s.period)
    throw Error{fmt::format("adaptive inverse: a3/a2 is {} s, expected at least the period of {} s",
                            s.initial.a3 / s.initial.a2, s.period)};
  if (!(InverseLead::vector_of(s.uncertainty).minCoeff() >= 0) ||
      !InverseLead::vector_of(s.initial).allFinite())
    throw Error{
        "adaptive inverse: expected finite initial coefficients and uncertainties of 0 or more"};
  return s;
}

}  // namespace

AdaptiveInverse::AdaptiveInverse(const AdaptiveInverseSettings& settings)
    : settings_{checked(settings)},
      initial_{InverseLead::vector_of(settings.initial)},
      uncertainty_{InverseLead::vector_of(settings.uncertainty)},
      normal_{Eigen::Matrix<double, kTerms, kTerms>::Zero()},
      lead_{settings},
      filters_(kTerms + 1, maths::LowPass{kLearningFilterOrder, settings.cutoff, settings.period}),
      error_filter_{kLearningFilterOrder, settings.cutoff, settings.period} {
  machine_.fill(Channels::Zero());
}

InverseCoefficients AdaptiveInverse::coefficients() const {
  return InverseLead::coefficients_of(initial_ + change_);
}

double AdaptiveInverse::sent(double share, const Pace& pace) noexcept {
  const double reference = lead_.reference(initial_ + change_, share);
  if (lead_.is_clipped()) ++clipped_;
  if (lead_.is_clipped() || pace.share < 1) pause_ = std::lround(kPause / settings_.period);
  return reference;
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
  learning_ = is_informative(regressors[kVelocityTerm], error, is_good) && adapt;
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

double AdaptiveInverse::step(double target, double measured, double force, double share, bool adapt,
                             const Pace& pace) noexcept {
  const bool is_good = std::isfinite(target) && std::isfinite(measured) && std::isfinite(force);
  if (!is_good) ++bad_samples_;
  if (std::isfinite(target)) last_target_ = target;
  if (std::isfinite(measured)) last_measured_ = measured;
  if (std::isfinite(force)) last_force_ = force;

  lead_.advance(last_target_, last_force_, pace);
  const double reference = sent(share, pace);
  Channels sent_now;
  sent_now << lead_.terms(),
      reference - initial_.dot(lead_.terms()) - settings_.a4 * lead_.fourth_derivative();
  learn(sent_now, last_measured_ - last_target_, is_good, adapt);
  if (learning_ && tick_ % std::lround(kSolvePeriod / settings_.period) == 0) solve();
  if (adapt) change_ += settings_.period / kBlend * (wanted_ - change_);
  ++tick_;
  return reference;
}

}  // namespace rths::controller
