// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/signal.hpp>

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace rths::diagnosis {
namespace {

using Eigen::VectorXd;

constexpr double kStep = 1e-3;

VectorXd sine(double frequency, int samples) {
  VectorXd x(samples);
  for (int i = 0; i < samples; ++i) x[i] = std::sin(2 * std::numbers::pi * frequency * i * kStep);
  return x;
}

VectorXd noise(int samples, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  VectorXd x(samples);
  for (double& value : x) value = normal(random);
  return x;
}

// Two passes of a Butterworth filter of order n: 1/(1 + (tan πfΔt / tan πf_cΔt)^2n), no phase.
TEST(LowPassed, HasTheSquaredGainOfAButterworthAndNoPhase) {
  for (const double f : {5.0, 25.0, 60.0}) {
    const VectorXd x = sine(f, 8000);
    const VectorXd y = low_passed(x, 4, 25, kStep);

    const double ratio =
        std::tan(std::numbers::pi * f * kStep) / std::tan(std::numbers::pi * 25 * kStep);
    const double gain = 1 / (1 + std::pow(ratio, 8));
    const auto middle = Eigen::seqN(2000, 4000);
    EXPECT_LT((y(middle) - gain * x(middle)).cwiseAbs().maxCoeff(), 1e-3 * gain) << f;
  }
}

TEST(LowPassed, PreservesALineUpToItsEnds) {
  const VectorXd line = VectorXd::LinSpaced(500, 3, 7);

  EXPECT_LT((low_passed(line, 4, 25, kStep) - line).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(LowPassed, HasTheSameColumnsTogetherAsAlone) {
  for (const int columns : {1, 2, 4, 5}) {
    Eigen::MatrixXd signals(700, columns);
    for (int i = 0; i < columns; ++i)
      signals.col(i) = sine(3 + i, 700) + noise(700, static_cast<unsigned>(i));

    const Eigen::MatrixXd together = low_passed_columns(signals, 4, 25, kStep);

    for (int i = 0; i < columns; ++i)
      EXPECT_EQ(together.col(i), low_passed(signals.col(i), 4, 25, kStep)) << columns << ", " << i;
  }
}

// Bands end at 500/∛2^k Hz. Those above 24.8 Hz hold noise alone; 19.7 to 24.8 Hz has the sine. Its
// leakage is 31 dB lower two bins of 1 Hz away, less than the noise.
TEST(NoiseBegins, AboveTheLastBandWithASignal) {
  std::vector<VectorXd> signals, at_rest;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    signals.push_back(3 * sine(21.5, 20'000) + noise(20'000, seed));
    at_rest.push_back(noise(2000, 10 + seed));
  }

  EXPECT_NEAR(noise_begins(signals, at_rest, kStep), 500 / std::pow(2, 13 / 3.0), 1e-9);
}

TEST(NoiseBegins, AtTheNyquistFrequencyOfSignalsThatExceedTheNoiseThere) {
  EXPECT_EQ(noise_begins({2 * noise(20'000, 1)}, {noise(2000, 2)}, kStep), 500);
  EXPECT_EQ(noise_begins({noise(20'000, 1)}, {VectorXd::Zero(2000)}, kStep), 500);
  EXPECT_EQ(noise_begins({noise(20'000, 1)}, {noise(50, 2)}, kStep), 500);  // too short
}

TEST(Fused, UsesDisplacementAtLowAndAccelerationAtHighFrequencies) {
  const int n = 20'000;
  VectorXd truth(n), acceleration(n);
  for (int i = 0; i < n; ++i) {
    const double t = i * kStep, g = std::exp(-std::pow((t - 10) / 3, 2));
    const double w1 = 2 * std::numbers::pi * 0.3, w2 = 2 * std::numbers::pi * 12;
    truth[i] = g * (std::sin(w1 * t) + 0.01 * std::sin(w2 * t));
  }
  for (int i = 1; i + 1 < n; ++i)
    acceleration[i] = (truth[i + 1] - 2 * truth[i] + truth[i - 1]) / (kStep * kStep);
  acceleration[0] = acceleration[n - 1] = 0;
  const VectorXd noisy = truth + 1e-3 * noise(n, 1);

  const VectorXd u = fused(noisy, acceleration, 2, kStep);

  // The white noise of the displacement remains below about 2 Hz of 500 Hz.
  EXPECT_LT((u - truth).norm(), 0.15 * (noisy - truth).norm());
}

TEST(Fused, IsAsGoodAtTheEndsOfARecordThatIsCutOutOfAMotion) {
  const int n = 10'370;
  const double w = 2 * std::numbers::pi;
  VectorXd truth(n), acceleration(n);
  for (int i = 0; i < n; ++i) {
    const double t = i * kStep;
    truth[i] = 0.1 * std::sin(w * t) + 0.01 * std::sin(5.3 * w * t + 1);
    acceleration[i] = -w * w * (0.1 * std::sin(w * t) + 0.2809 * std::sin(5.3 * w * t + 1));
  }
  const VectorXd noisy = truth + 5e-5 * noise(n, 1);

  const VectorXd u = fused(noisy, acceleration, 5, kStep);

  // Of the displacement's noise, whose deviation is 5e-5: little within the record, and not more
  // than one sample's at its ends.
  EXPECT_LT((u - truth).norm() / std::sqrt(n), 0.2 * 5e-5);
  EXPECT_LT((u - truth).cwiseAbs().maxCoeff(), 4 * 5e-5);
}

TEST(AutoRegression, IsFoundAgainAndWhitens) {
  AutoRegression truth{VectorXd{{1.2, -0.5}}, 0.3};
  const VectorXd x = truth.coloured(noise(50'000, 2));

  const AutoRegression found = auto_regression({x}, 4);

  // Standard deviations are about 1/√n = 0.0045.
  EXPECT_NEAR(found.coefficients[0], 1.2, 0.02);
  EXPECT_NEAR(found.coefficients[1], -0.5, 0.02);
  EXPECT_NEAR(found.coefficients[3], 0, 0.02);
  EXPECT_NEAR(found.deviation, 0.3, 0.005);
  EXPECT_NEAR(found.whitened(x).squaredNorm() / 50'000, 1, 0.02);
}

TEST(PowerSpectrum, KeepsTheVariance) {
  const VectorXd x = noise(100'000, 3);

  const Spectrum s = power_spectrum(x, 512, kStep);

  const double width = s.frequency[1] - s.frequency[0];
  EXPECT_NEAR(s.density.sum() * width, 1, 0.02);
  EXPECT_NEAR(s.density[100], 2 * kStep, 0.3 * 2 * kStep);
}

TEST(RateOf, IsExactForAParabola) {
  VectorXd x(100);
  for (int i = 0; i < 100; ++i) x[i] = std::pow(i * kStep, 2);

  EXPECT_NEAR(rate_of(x, kStep)[50], 2 * 50 * kStep, 1e-12);
}

TEST(SecondRate, IsExactForACubic) {
  VectorXd x(50), expected(50);
  for (int i = 0; i < 50; ++i) {
    const double t = i * kStep;
    x[i] = 2 * t * t * t - 3 * t * t + 1;
    expected[i] = 12 * t - 6;
  }

  const VectorXd found = second_rate_of(x, kStep);

  EXPECT_LT((found - expected).segment(1, 48).cwiseAbs().maxCoeff(), 1e-6);
}

NoiseSpectrum spectrum_of(const std::vector<VectorXd>& signals) {
  std::vector<Stretch> stretches;
  for (const auto& signal : signals) stretches.push_back({signal, kStep});
  return NoiseSpectrum{stretches};
}

TEST(NoiseSpectrum, IsFlatForWhiteNoise) {
  const NoiseSpectrum spectrum = spectrum_of({noise(4000, 1), noise(4000, 2)});

  // One-sided, of variance 1: 2 Δt. Three deviations: a third octave at 40 Hz has 50 degrees of
  // freedom.
  for (const double f : {5.0, 40.0, 300.0})
    EXPECT_NEAR(spectrum.density(f) / (2 * kStep), 1, f < 100 ? 0.4 : 0.16) << f;
}

TEST(NoiseSpectrum, GeneratesNoiseOfItsOwnDensity) {
  // x(t) = 0.95 x(t-1) + e(t): density 2 Δt / |1 - 0.95 exp(-i 2 π f Δt)|².
  const auto red = [](int samples, unsigned seed) -> VectorXd {
    VectorXd x = noise(samples, seed);
    for (int i = 1; i < samples; ++i) x[i] += 0.95 * x[i - 1];
    return x;
  };
  const NoiseSpectrum spectrum = spectrum_of({red(4000, 1), red(4000, 2), red(4000, 3)});
  std::mt19937 random{7};
  std::normal_distribution<double> normal;

  const VectorXd drawn = spectrum.generator(100'000, kStep).draw([&] { return normal(random); });

  const Spectrum found = power_spectrum(drawn, 1024, kStep);
  for (const int bin : {5, 20, 80, 300}) {
    const double w = 2 * std::numbers::pi * found.frequency[bin] * kStep;
    const double truth = 2 * kStep / (1 + 0.95 * 0.95 - 2 * 0.95 * std::cos(w));
    EXPECT_NEAR(found.density.segment(bin - 2, 5).mean() / truth, 1, 0.35) << bin;
  }
}

double variance_of_draw(const NoiseSpectrum& spectrum, int samples) {
  std::mt19937 random{11};
  std::normal_distribution<double> normal;
  const VectorXd x = spectrum.generator(samples, kStep).draw([&] { return normal(random); });
  return (x.array() - x.mean()).square().mean();
}

// A line among bands of one or two bins holds most of the energy. The interpolation between bands
// widens it.
TEST(NoiseSpectrum, KeepsALineAmongFewBins) {
  constexpr int kSamples = 2000;
  const VectorXd line =
      5 * VectorXd::LinSpaced(kSamples, 0, 12 * 2 * std::numbers::pi).array().sin();
  const NoiseSpectrum spectrum = spectrum_of({line + noise(kSamples, 3)});

  EXPECT_NEAR(variance_of_draw(spectrum, 60 * kSamples) / (25.0 / 2 + 1), 1, 0.35);
}

// White noise is as large in a record as at rest, whatever the record's length.
TEST(NoiseSpectrum, DoesNotRiseBelowAShortStretchOfWhiteNoise) {
  double rise = 0;
  constexpr int kTrials = 40;
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    const NoiseSpectrum spectrum = spectrum_of({noise(500, 100 + seed)});
    rise += spectrum.density(0.2 / (500 * kStep)) / (2 * kStep) / kTrials;
  }
  // The mean of 40 estimates from about 3 bins each scatters by a tenth.
  EXPECT_NEAR(rise, 1, 0.4);
}

// A random walk rises as f⁻², and the extrapolation at most as f⁻¹.
TEST(NoiseSpectrum, RisesBelowAShortStretchOfDrift) {
  VectorXd walk = noise(4000, 5);
  for (int i = 1; i < walk.size(); ++i) walk[i] += walk[i - 1];
  const NoiseSpectrum spectrum = spectrum_of({walk});
  const double lowest = 1.5 / (4000 * kStep);

  EXPECT_NEAR(spectrum.density(lowest / 2) / spectrum.density(lowest), 2, 0.05);
}

}  // namespace
}  // namespace rths::diagnosis
