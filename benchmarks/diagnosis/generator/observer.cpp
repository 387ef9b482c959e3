// SPDX-License-Identifier: Apache-2.0
#include "observer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trial {
namespace {

constexpr std::size_t kDraws = 40;
constexpr double kVarianceWindow = 0.25;  ///< on each side [s]
constexpr std::uint64_t kStream = 0x6e6f697365;

double resolution_density(double step) { return step * step / 12 * kSampleTime; }

// Root of the mean square of all draws, smoothed over time.
Signal deviation_of(const std::vector<Signal>& draws) {
  const auto reach = static_cast<std::ptrdiff_t>(kVarianceWindow * kCompareRate);
  const auto samples = static_cast<std::ptrdiff_t>(draws[0].size());
  Signal deviation;
  for (std::ptrdiff_t centre = 0; centre < samples; ++centre) {
    double sum = 0, weights = 0;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(centre - reach, 0);
         k <= std::min(centre + reach, samples - 1); ++k) {
      const double weight =
          0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(k - centre) /
                               static_cast<double>(reach + 1));
      for (const Signal& draw : draws)
        sum += weight * draw[static_cast<std::size_t>(k)] * draw[static_cast<std::size_t>(k)];
      weights += weight * static_cast<double>(draws.size());
    }
    deviation.push_back(std::sqrt(sum / weights));
  }
  return deviation;
}

template <std::size_t N>
using Lags = std::array<double, N>;

// Levinson's recursion: from the autocovariance to the predictor and its error variance.
template <std::size_t Order>
double predictor(const Lags<Order + 1>& covariance, Lags<Order>& keeps) {
  double left = covariance[0];
  for (std::size_t m = 0; m < Order; ++m) {
    double reflection = covariance[m + 1];
    for (std::size_t k = 0; k < m; ++k) reflection -= keeps[k] * covariance[m - k];
    reflection /= left;
    const Lags<Order> before = keeps;
    keeps[m] = reflection;
    for (std::size_t k = 0; k < m; ++k) keeps[k] = before[k] - reflection * before[m - 1 - k];
    left *= 1 - reflection * reflection;
  }
  return left;
}

}  // namespace

Observer::Observer(const TrialCase& trial, std::size_t record, Relation relation)
    : record_(trial.records[record]),
      noise_(trial.noise),
      relation_(relation),
      motion_(true_motion(record_)) {
  if (relation == Relation::Force) learn_force_noise(trial.physics_of(record));
}

void Observer::learn_force_noise(const Physics& physics) {
  Random random{kStream, record_.force.size()};
  std::array<std::vector<Signal>, 2> draws;
  const std::vector<Plane> exact = force_at(physics, motion_);
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    std::vector<Plane> error = force_at(physics, sum(motion_, motion_error(noise_, random)));
    Noise x{noise_.force, kModelStep, random}, y{noise_.force, kModelStep, random};
    for (std::size_t k = 0; k < error.size(); ++k)
      error[k] = {error[k][0] - exact[k][0] + x.next(random),
                  error[k][1] - exact[k][1] + y.next(random)};
    for (std::size_t i = 0; i < 2; ++i) draws[i].push_back(compared(axis_of(error, i), kModelStep));
  }
  constexpr double kRidge = 0.02;  // the signal has no energy above the band: limits the gain there
  for (std::size_t i = 0; i < 2; ++i) {
    whitener_[i].deviation = deviation_of(draws[i]);
    Lags<kOrder + 1> covariance{};
    for (const Signal& draw : draws[i])
      for (std::size_t k = kOrder; k < draw.size(); ++k)
        for (std::size_t lag = 0; lag <= kOrder; ++lag)
          covariance[lag] += draw[k] * draw[k - lag] / whitener_[i].deviation[k] /
                             whitener_[i].deviation[k - lag] /
                             static_cast<double>(kDraws * (draw.size() - kOrder));
    covariance[0] *= 1 + kRidge;
    whitener_[i].scale = 1 / std::sqrt(predictor<kOrder>(covariance, whitener_[i].keeps));
  }
}

Signal Observer::whitened_force(const std::vector<Plane>& force, double sample_time) const {
  Signal both;
  for (std::size_t i = 0; i < 2; ++i) {
    const Whitener& whitener = whitener_[i];
    Signal scaled = compared(axis_of(force, i), sample_time);
    for (std::size_t k = 0; k < scaled.size(); ++k) scaled[k] /= whitener.deviation[k];
    for (std::size_t k = 0; k < scaled.size(); ++k) {
      double innovation = scaled[k];
      for (std::size_t lag = 1; lag <= std::min(kOrder, k); ++lag)
        innovation -= whitener.keeps[lag - 1] * scaled[k - lag];
      both.push_back(innovation * whitener.scale);
    }
  }
  return both;
}

// Two-sided noise density of the relation's channel, given the other channel.
double Observer::density(double frequency_Hz) const {
  const double omega = 2 * std::numbers::pi * frequency_Hz;
  const double omega4 = std::pow(omega, 4);
  const double u =
      noise_.displacement.density(frequency_Hz) + resolution_density(kDisplacementResolution);
  const double a =
      noise_.acceleration.density(frequency_Hz) + resolution_density(kAccelerationResolution);
  // Kinematic compares the two channels; otherwise both measure the platen's position.
  return relation_ == Relation::Kinematic ? a + omega4 * u : 1 / (1 / u + omega4 / a);
}

Signal Observer::whitened(const std::vector<Plane>& motion) const {
  constexpr double kFade = 1;  // at the end [s]
  const double per_sample = 1 / std::sqrt(kCompareRate);
  const auto stride = static_cast<std::size_t>(std::lround(1 / (kCompareRate * kSampleTime)));
  Signal both;
  for (std::size_t i = 0; i < 2; ++i) {
    Signal signal = axis_of(motion, i);
    for (std::size_t k = 0; k < signal.size(); ++k) {
      const double left = static_cast<double>(signal.size() - k) * kSampleTime;
      if (left < kFade) signal[k] *= 0.5 - 0.5 * std::cos(std::numbers::pi * left / kFade);
    }
    const Signal white = filtered(spectrum_of(signal), kSampleTime, signal.size(), [&](double f) {
      return f < kCompareBand ? per_sample / std::sqrt(density(f)) : 0;
    });
    for (std::size_t k = 0; k < white.size(); k += stride) both.push_back(white[k]);
  }
  return both;
}

Signal Observer::seen(const Physics& physics) const {
  if (relation_ == Relation::Force) return whitened_force(force_at(physics, motion_), kModelStep);
  if (relation_ == Relation::Actuator) return whitened(displacement_at(physics, record_));
  std::vector<Plane> acceleration;
  for (const Boundary& now : record_.truth) acceleration.push_back(accelerometer(physics, now));
  return whitened(acceleration);
}

Signal Observer::seen_of_recorder() const {
  std::vector<Plane> difference = record_.force;
  for (std::size_t k = 0; k < difference.size(); ++k)
    for (std::size_t i = 0; i < 2; ++i) difference[k][i] -= record_.fine_force[k][i];
  return whitened_force(difference, kSampleTime);
}

}  // namespace trial
