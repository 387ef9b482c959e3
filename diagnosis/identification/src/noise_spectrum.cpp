// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include <rths/core/error.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/signal.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/fourier.hpp>

namespace rths::diagnosis {
namespace {

// Adds the periodogram of one stretch to sums over bands.
void add_periodogram(const Stretch& stretch, std::vector<double>& sums,
                     std::vector<double>& frequencies, std::vector<double>& counts, double lowest) {
  const auto& [samples, time_step] = stretch;
  const Index n = samples.size();
  const VectorXd weight = maths::hann_window(n, 0.5);
  const VectorXd x = (samples.array() - samples.mean()) * weight.array();
  const Index length = maths::fast_length(n);
  VectorXd padded = VectorXd::Zero(length);
  padded.head(n) = x;
  const VectorXcd bins = maths::spectrum(padded);
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

// The logarithm of a mean of periodogram bins: bins are exponentially distributed, so the mean has
// a gamma distribution (Bartlett & Kendall 1946). Neighbouring bins of a Hann window are
// correlated.
struct LogOfMean {
  double bias, variance;

  explicit LogOfMean(double count) {
    const double n = std::max(1.0, count / kBinsOfWindow);
    bias = -1 / (2 * n) - 1 / (12 * n * n);
    variance = 1 / n + 1 / (2 * n * n) + 1 / (6 * n * n * n);
  }
};

// Polynomial of the smallest degree, up to three, that a series of values supports: each power must
// reduce χ² by more than chance does (1 in the mean, 6.6 once in a hundred).
VectorXd smooth_polynomial(const VectorXd& x, const VectorXd& y, const VectorXd& variance) {
  const VectorXd weight = variance.cwiseSqrt().cwiseInverse();
  const VectorXd target = weight.cwiseProduct(y);
  VectorXd best;
  double least = 0;
  for (Index degree = 0; degree <= 3; ++degree) {
    MatrixXd powers = MatrixXd::Ones(x.size(), degree + 1);
    for (Index k = 1; k <= degree; ++k) powers.col(k) = powers.col(k - 1).cwiseProduct(x);
    const MatrixXd weighted = weight.asDiagonal() * powers;
    const VectorXd fitted = powers * maths::solve_least_squares(weighted, target);
    const double cost = weight.cwiseProduct(y - fitted).squaredNorm() +
                        kChanceOfPower * static_cast<double>(degree);
    if (degree == 0 || cost < least) best = fitted, least = cost;
  }
  return best;
}

// Densities of bands with few bins scatter. Noise whose log density is a polynomial of log
// frequency within this scatter becomes that polynomial; lines in the spectrum remain. @returns
// which it is
bool smooth_few(const std::vector<double>& counts, const std::vector<double>& frequency,
                std::vector<double>& density) {
  const auto n = static_cast<Index>(counts.size());
  if (n < 8 || std::any_of(density.begin(), density.end(), [](double d) { return !(d > 0); }))
    return true;
  VectorXd log_frequency(n), log_density(n), variance(n);
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const LogOfMean scatter{counts[k]};
    log_frequency[i] = std::log(frequency[k] / frequency[counts.size() / 2]);
    log_density[i] = std::log(density[k]) - scatter.bias;
    variance[i] = std::max(scatter.variance, kLeastVarianceOfBand);
  }
  const VectorXd smooth = smooth_polynomial(log_frequency, log_density, variance);
  const double chi_square = ((log_density - smooth).array().square() / variance.array()).sum();
  const auto bands = static_cast<double>(n);
  const bool is_smooth = chi_square < bands + 2 * std::sqrt(2 * bands);
  if (is_smooth)
    for (Index i = 0; i < n; ++i) density[static_cast<std::size_t>(i)] = std::exp(smooth[i]);
  return is_smooth;
}

// Slope of log density over log frequency towards low frequencies, over the lowest octave.
double slope_of(const std::vector<double>& frequency, const std::vector<double>& density) {
  constexpr auto kOctave = static_cast<std::size_t>(kBandsPerOctave);
  if (density.size() <= kOctave || !(density[0] > 0) || !(density[kOctave] > 0)) return 0;
  return std::clamp(
      std::log(density[0] / density[kOctave]) / std::log(frequency[kOctave] / frequency[0]), 0.0,
      1.0);
}

}  // namespace

NoiseSpectrum::NoiseSpectrum(double deviation, double time_step)
    : frequency_{1}, density_{2 * deviation * deviation * time_step}, deviation_{deviation} {}

NoiseSpectrum::NoiseSpectrum(const std::vector<Stretch>& stretches) {
  Index most = 0;
  double longest = 0, least_step = std::numeric_limits<double>::infinity();
  double square = 0, count = 0;
  for (const auto& [samples, time_step] : stretches) {
    most = std::max(most, samples.size());
    longest = std::max(longest, static_cast<double>(samples.size()) * time_step);
    least_step = std::min(least_step, time_step);
    square += (samples.array() - samples.mean()).square().sum();
    count += static_cast<double>(samples.size());
  }
  deviation_ = std::sqrt(square / std::max(count, 1.0));
  if (most < 16) throw Error{"noise model: too few samples at rest"};
  // The main lobe of the window spans two bins: below, removing the mean distorts the density.
  const double lowest = 1.5 / longest;
  const auto bands =
      static_cast<std::size_t>(kBandsPerOctave * std::log2(0.5 / least_step / lowest)) + 1;
  std::vector<double> sums(bands), frequencies(bands), counts(bands);
  for (const auto& stretch : stretches)
    if (stretch.samples.size() >= std::llround(longest / stretch.time_step) / 2)
      add_periodogram(stretch, sums, frequencies, counts, lowest);
  std::vector<double> kept;
  for (std::size_t i = 0; i < bands; ++i) {
    if (counts[i] == 0) continue;
    frequency_.push_back(std::exp(frequencies[i] / counts[i]));
    density_.push_back(sums[i] / counts[i]);
    kept.push_back(counts[i]);
  }
  is_smooth_ = smooth_few(kept, frequency_, density_);
  slope_ = slope_of(frequency_, density_);
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
    // Drift continues below the lowest frequency of a short stretch, as steeply as above it.
    return density_.front() *
           std::min(std::pow(frequency_.front() / std::max(frequency, 1e-9), slope_), kMostRise);
  }
  if (above == frequency_.end()) return density_.back();
  const auto i = static_cast<std::size_t>(above - frequency_.begin());
  const double share =
      std::log(frequency / frequency_[i - 1]) / std::log(frequency_[i] / frequency_[i - 1]);
  // A line has the width of its band; else linear interpolation of log density over log frequency.
  if (!is_smooth_ || !(density_[i - 1] > 0) || !(density_[i] > 0))
    return density_[share < 0.5 ? i - 1 : i];
  return density_[i - 1] * std::pow(density_[i] / density_[i - 1], share);
}

bool NoiseSpectrum::is_nothing() const {
  return std::none_of(density_.begin(), density_.end(), [](double d) { return d > 0; });
}

NoiseSpectrum::Generator NoiseSpectrum::generator(Index samples, double time_step) const {
  Generator generator;
  generator.samples_ = samples;
  generator.length_ = maths::fast_length(samples + samples % 2);
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
  VectorXcd bins(length_);
  bins.setZero();
  for (Index k = 1; k <= length_ / 2; ++k) {
    const std::complex<double> bin{size_[k - 1] * random(), size_[k - 1] * random()};
    bins[k] = bin;
    bins[(length_ - k) % length_] = std::conj(bin);
  }
  return maths::signal_of(bins).head(samples_);
}

}  // namespace rths::diagnosis
