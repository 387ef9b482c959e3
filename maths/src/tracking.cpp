// SPDX-License-Identifier: Apache-2.0
#include <rths/maths/tracking.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Core>

#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/delay.hpp>
#include <rths/maths/fourier.hpp>
#include <rths/maths/robust_covariance.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::maths {
namespace {

constexpr int kMostFitIterations = 30;
constexpr double kFitConverged = 1e-6;  // samples
// Most lags of the correlation of a residual, as a fraction of a record.
constexpr double kLagFraction = 0.1;

/// Value and rate per sample of a signal between its samples: the cubic through four neighbours.
struct Between {
  double value, rate;
};
Between between(std::span<const double> x, double position) {
  const auto i = static_cast<std::size_t>(
      std::clamp(std::floor(position), 1.0, static_cast<double>(x.size()) - 3));
  const double s = position - static_cast<double>(i);
  const double a = x[i - 1], b = x[i], c = x[i + 1], d = x[i + 2];
  const double first = c - a / 3 - b / 2 - d / 6, second = (a + c) / 2 - b;
  const double third = (d - a) / 6 + (b - c) / 2;
  return {b + s * (first + s * (second + s * third)), first + s * (2 * second + s * 3 * third)};
}

/// Rows of a fit: residual and its derivatives by delay [samples], gain and offset.
struct FitRows {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
};

/// A reference as it is measured: delay [samples], gain and offset.
struct Answer {
  double delay = 0, gain = 1, offset = 0;
};

FitRows fit_rows(std::span<const double> reference, std::span<const double> measured, long reach,
                 const Answer& answer, Gain rule) {
  const auto size = static_cast<long>(reference.size());
  const long count = size - 2 * reach;
  FitRows rows{Eigen::MatrixXd(count, rule == Gain::Free ? 3 : 2), Eigen::VectorXd(count)};
  for (long k = 0; k < count; ++k) {
    const long i = k + reach;
    const auto r = between(reference, static_cast<double>(i) - answer.delay);
    rows.residual[k] =
        measured[static_cast<std::size_t>(i)] - answer.gain * r.value - answer.offset;
    rows.jacobian(k, 0) = -answer.gain * r.rate;
    rows.jacobian(k, 1) = 1;
    if (rule == Gain::Free) rows.jacobian(k, 2) = r.value;
  }
  return rows;
}

// Of the varying part, in a Hann window.
Eigen::VectorXcd spectrum_of(std::span<const double> values) {
  const auto size = static_cast<Eigen::Index>(values.size());
  Eigen::Index length = 1;
  while (length < size) length *= 2;
  Eigen::VectorXd padded = Eigen::VectorXd::Zero(length);
  padded.head(size) =
      (Eigen::Map<const Eigen::ArrayXd>{values.data(), size} - mean(values)).matrix();
  padded.head(size).array() *= hann_window(size, 0.5).array();
  return half_spectrum(padded);
}

// Two-sided 95 % quantile of Student's distribution: first terms of the expansion by 1/ν.
// Source: Abramowitz & Stegun (1964), 26.7.5.
double student95(double degrees) {
  const double z = kHalfWidth95;
  const double first = (z * z * z + z) / 4;
  const double second = (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / 96;
  return z + first / degrees + second / (degrees * degrees);
}

}  // namespace

DelayFit fit_delay(std::span<const double> reference, std::span<const double> measured,
                   double time_step, double search, Gain rule) {
  const auto coarse = identify_delay(reference, measured, time_step, search);
  double delay = (rule == Gain::Free ? coarse.cross_correlation : coarse.minimum_rms) / time_step;
  const long reach = std::lround(search / time_step) + 3;
  if (reference.size() < static_cast<std::size_t>(4 * reach))
    throw Error{"delay: the signals are too short for the range of shifts"};
  DelayFit fit;
  const double limit = search / time_step;
  FitRows rows;
  for (int i = 0; i < kMostFitIterations; ++i) {
    rows = fit_rows(reference, measured, reach, {delay, fit.gain, fit.offset}, rule);
    const Eigen::VectorXd change = solve_least_squares(rows.jacobian, rows.residual);
    const double step = std::clamp(change[0], -1.0, 1.0);
    delay = std::clamp(delay + step, -limit, limit);
    fit.offset += change[1];
    if (rule == Gain::Free) fit.gain += change[2];
    if (std::abs(step) < kFitConverged) break;
  }
  rows = fit_rows(reference, measured, reach, {delay, fit.gain, fit.offset}, rule);
  const auto most = std::lround(kLagFraction * static_cast<double>(rows.residual.size()));
  const Eigen::MatrixXd covariance =
      robust_covariance(rows.jacobian, rows.residual, correlated_lags(rows.residual, most));
  fit.delay = delay * time_step;
  fit.delay_95 = kHalfWidth95 * std::sqrt(covariance(0, 0)) * time_step;
  if (rule == Gain::Free) fit.gain_95 = kHalfWidth95 * std::sqrt(covariance(2, 2));
  fit.residual_rms =
      std::sqrt(rows.residual.squaredNorm() / static_cast<double>(rows.residual.size()));
  return fit;
}

FrequencyIndex frequency_index(std::span<const double> reference, std::span<const double> measured,
                               double time_step, double near) {
  if (reference.size() != measured.size())
    throw Error{"frequency index: the two signals differ in length"};
  // Both signals are cut so that the measured one is moved by whole samples.
  const long shift = std::lround(near / time_step);
  const auto moved = static_cast<std::size_t>(std::abs(shift));
  if (moved + 8 > reference.size())
    throw Error{"frequency index: the signals are too short for the delay"};
  const std::size_t length = reference.size() - moved;
  const auto r = reference.subspan(shift >= 0 ? 0 : moved, length);
  const auto m = measured.subspan(shift >= 0 ? moved : 0, length);
  const Eigen::VectorXcd input = spectrum_of(r), output = spectrum_of(m);
  const Eigen::VectorXd power = input.cwiseAbs2();
  const double sum = power.sum();
  if (!(sum > 0)) throw Error{"frequency index: the reference is constant"};
  const double spacing = 0.5 / (static_cast<double>(input.size() - 1) * time_step);
  FrequencyIndex index;
  index.frequency = power.dot(Eigen::VectorXd::LinSpaced(power.size(), 0,
                                                         static_cast<double>(power.size() - 1))) *
                    spacing / sum;
  const std::complex<double> response = input.dot(output) / sum;  // dot conjugates the input
  const double omega = 2 * std::numbers::pi * index.frequency;
  const double rest = -std::arg(response) / omega;
  index.amplitude = std::abs(response);
  index.delay = rest + static_cast<double>(shift) * time_step;
  double spread = 0;
  for (Eigen::Index i = 0; i < power.size(); ++i) {
    const double phase = -2 * std::numbers::pi * static_cast<double>(i) * spacing * rest;
    spread += power[i] * std::norm(output[i] - std::polar(index.amplitude, phase) * input[i]);
  }
  // The window and the padding correlate neighbouring frequencies: by 35/18 (Hann) times the factor
  // of the padding.
  const double padding = static_cast<double>(2 * (input.size() - 1)) / static_cast<double>(length);
  const double correlated = 35.0 / 18 * padding;
  const double independent =
      std::max(1.5, sum * sum / (power.squaredNorm() * correlated));  // frequencies
  const double variance = correlated * spread / (sum * sum) * independent / (independent - 1);
  const double half_width = student95(2 * (independent - 1)) * std::sqrt(variance / 2);
  index.amplitude_95 = half_width;
  index.delay_95 = half_width / (index.amplitude * omega);
  return index;
}

std::vector<Window> moving_windows(std::span<const double> reference, std::size_t length,
                                   double least_rms) {
  std::vector<Window> windows;
  if (length < 2) return windows;
  for (std::size_t begin = 0; begin + length <= reference.size(); begin += length / 2)
    if (deviation(reference.subspan(begin, length)) >= least_rms)
      windows.push_back({begin, length});
  return windows;
}

}  // namespace rths::maths
