// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Core>

#include <rths/algebra/decompositions.hpp>
#include <rths/core/error.hpp>
#include <rths/identification/signal.hpp>

#include "transform.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kBandsPerOctave = 3;
constexpr double kMostRise = 3;  // of the density towards low frequencies, over the first band's

// Adds the periodogram of one stretch to sums over bands.
void add_periodogram(const VectorXd& stretch, double time_step, std::vector<double>& sums,
                     std::vector<double>& frequencies, std::vector<double>& counts, double lowest) {
  const Index n = stretch.size();
  VectorXd weight(n);
  for (Index i = 0; i < n; ++i)
    weight[i] = 0.5 * (1 - std::cos(2 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                    static_cast<double>(n)));
  const VectorXd x = (stretch.array() - stretch.mean()) * weight.array();
  const Index length = fast_length(n);
  VectorXd padded = VectorXd::Zero(length);
  padded.head(n) = x;
  Eigen::VectorXcd bins;
  transformer().fwd(bins, padded);
  const double scale = 2 * time_step / weight.squaredNorm();
  for (Index k = 1; k <= length / 2; ++k) {
    const double f = static_cast<double>(k) / (static_cast<double>(length) * time_step);
    if (f < lowest) continue;
    const auto band = static_cast<std::size_t>(kBandsPerOctave * std::log2(f / lowest));
    if (band >= sums.size()) continue;
    sums[band] += scale * std::norm(bins[k]);
    frequencies[band] += std::log(f);
    counts[band] += 1;
  }
}

// Replaces the density of bands with few bins, which scatter, by a cubic of log density over log
// frequency through all bands.
void smooth_few(const std::vector<double>& counts, const std::vector<double>& frequency,
                std::vector<double>& density) {
  constexpr double kFew = 40;
  const auto n = static_cast<Index>(counts.size());
  if (n < 8 || std::any_of(density.begin(), density.end(), [](double d) { return !(d > 0); }))
    return;
  Eigen::MatrixXd design(n, 4);
  VectorXd log_density(n);
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    // Above some tens of bins, the scatter of a band is smaller than the error of the cubic.
    const double weight = std::sqrt(std::min(counts[k], kFew));
    const double x = std::log(frequency[k] / frequency[counts.size() / 2]);
    design.row(i) << weight, weight * x, weight * x * x, weight * x * x * x;
    log_density[i] = weight * std::log(density[k]);
  }
  const VectorXd cubic = algebra::solve_least_squares(design, log_density);
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (counts[k] >= kFew) continue;
    const double weight = std::sqrt(std::min(counts[k], kFew));
    density[k] = std::exp(design.row(i).dot(cubic) / weight);
  }
}

}  // namespace

NoiseSpectrum::NoiseSpectrum(double deviation, double time_step)
    : frequency_{1}, density_{2 * deviation * deviation * time_step}, deviation_{deviation} {}

NoiseSpectrum::NoiseSpectrum(const std::vector<VectorXd>& stretches, double time_step) {
  Index longest = 0;
  double square = 0, samples = 0;
  for (const auto& stretch : stretches) {
    longest = std::max(longest, stretch.size());
    square += (stretch.array() - stretch.mean()).square().sum();
    samples += static_cast<double>(stretch.size());
  }
  deviation_ = std::sqrt(square / std::max(samples, 1.0));
  if (longest < 16) throw Error{"noise model: too few samples at rest"};
  // The main lobe of the window spans two bins: below, removing the mean distorts the density.
  const double lowest = 1.5 / (static_cast<double>(longest) * time_step);
  const auto bands =
      static_cast<std::size_t>(kBandsPerOctave * std::log2(0.5 / time_step / lowest)) + 1;
  std::vector<double> sums(bands), frequencies(bands), counts(bands);
  for (const auto& stretch : stretches)
    if (stretch.size() >= longest / 2)
      add_periodogram(stretch, time_step, sums, frequencies, counts, lowest);
  std::vector<double> kept;
  for (std::size_t i = 0; i < bands; ++i) {
    if (counts[i] == 0) continue;
    frequency_.push_back(std::exp(frequencies[i] / counts[i]));
    density_.push_back(sums[i] / counts[i]);
    kept.push_back(counts[i]);
  }
  smooth_few(kept, frequency_, density_);
}

NoiseSpectrum NoiseSpectrum::scaled(double factor) const {
  NoiseSpectrum result = *this;
  for (double& density : result.density_) density *= factor * factor;
  result.deviation_ *= std::abs(factor);
  return result;
}

double NoiseSpectrum::density(double frequency) const {
  if (frequency_.empty()) return 0;
  const auto above = std::upper_bound(frequency_.begin(), frequency_.end(), frequency);
  if (above == frequency_.begin()) {
    // Drift continues below the lowest frequency of a short stretch.
    const bool is_white = frequency_.size() == 1;
    return density_.front() *
           (is_white ? 1 : std::min(frequency_.front() / std::max(frequency, 1e-9), kMostRise));
  }
  if (above == frequency_.end()) return density_.back();
  const auto i = static_cast<std::size_t>(above - frequency_.begin());
  const double share =
      std::log(frequency / frequency_[i - 1]) / std::log(frequency_[i] / frequency_[i - 1]);
  // Linear interpolation of log density over log frequency.
  if (!(density_[i - 1] > 0) || !(density_[i] > 0)) return density_[i];
  return density_[i - 1] * std::pow(density_[i] / density_[i - 1], share);
}

bool NoiseSpectrum::is_nothing() const {
  return std::none_of(density_.begin(), density_.end(), [](double d) { return d > 0; });
}

NoiseSpectrum::Generator NoiseSpectrum::generator(Index samples, double time_step) const {
  Generator generator;
  generator.samples_ = samples;
  generator.length_ = fast_length(samples + samples % 2);
  if (is_nothing()) return generator;
  const auto length = static_cast<double>(generator.length_);
  generator.size_.resize(generator.length_ / 2);
  for (Index k = 1; k <= generator.length_ / 2; ++k) {
    const double f = static_cast<double>(k) / (length * time_step);
    generator.size_[k - 1] = std::sqrt(density(f) * length / (4 * time_step));
  }
  return generator;
}

VectorXd NoiseSpectrum::Generator::draw(const std::function<double()>& random) const {
  if (size_.size() == 0) return VectorXd::Zero(samples_);
  Eigen::VectorXcd bins(length_);
  bins.setZero();
  for (Index k = 1; k <= length_ / 2; ++k) {
    const std::complex<double> bin{size_[k - 1] * random(), size_[k - 1] * random()};
    bins[k] = bin;
    bins[(length_ - k) % length_] = std::conj(bin);
  }
  VectorXd signal;
  transformer().inv(signal, bins);
  return signal.head(samples_);
}

}  // namespace rths::diagnosis
