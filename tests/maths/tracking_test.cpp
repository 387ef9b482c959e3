// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/maths/robust_covariance.hpp>
#include <rths/maths/tracking.hpp>

namespace rths::maths {
namespace {

constexpr double kTrackingStep = 0.001, kTrackingSearch = 0.2;

// Two sines below an envelope, late and scaled. The highest frequency is 1.9 Hz.
std::vector<double> late_motion(double delay, double gain = 1, int samples = 12'000) {
  std::vector<double> values;
  for (int i = 0; i < samples; ++i) {
    const double t = i * kTrackingStep - delay;
    const double envelope = std::exp(-std::pow((t - 6) / 3, 2));
    values.push_back(gain * envelope *
                     (std::sin(2 * std::numbers::pi * 0.7 * t) +
                      0.4 * std::sin(2 * std::numbers::pi * 1.9 * t)));
  }
  return values;
}

// First-order autoregressive noise of standard deviation `size`.
std::vector<double> with_noise(std::vector<double> values, double size, double memory,
                               unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal{0, size * std::sqrt(1 - memory * memory)};
  double noise = 0;
  for (double& value : values) value += noise = memory * noise + normal(random);
  return values;
}

class FractionalDelay : public ::testing::TestWithParam<double> {};

// The cubic between samples errs by (ω h)⁴/24 of the signal: 1e-9 here, which is 1e-10 s of delay.
TEST_P(FractionalDelay, IsFoundExactlyWithGainAndOffset) {
  auto measured = late_motion(GetParam(), 0.93);
  for (double& value : measured) value += 0.05;

  const auto found = fit_delay(late_motion(0), measured, kTrackingStep, kTrackingSearch);

  EXPECT_NEAR(found.delay, GetParam(), 1e-8);
  EXPECT_NEAR(found.gain, 0.93, 1e-7);
  EXPECT_NEAR(found.offset, 0.05, 1e-7);
}

// One narrow band: the index of a pure delay is exact there. Here two lines share one delay.
TEST_P(FractionalDelay, IsFoundByTheFrequencyIndex) {
  const auto found =
      frequency_index(late_motion(0), late_motion(GetParam(), 0.93), kTrackingStep, GetParam());

  EXPECT_NEAR(found.delay, GetParam(), 1e-5);
  EXPECT_NEAR(found.amplitude, 0.93, 1e-3);
  // Between the lines at 0.7 and 1.9 Hz, whose powers are as 1 to 0.16.
  EXPECT_NEAR(found.frequency, (0.7 + 0.16 * 1.9) / 1.16, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Delays, FractionalDelay,
                         ::testing::Values(0.0, 0.0601, 0.00437, 0.00028, -0.0208, 0.15));

// RMS(m − r(τ)) with m = g r(τ₀) is smallest where the autocorrelation peaks: the gain does not
// shift it, and remains in the residual.
TEST(FixedGain, LeavesTheErrorOfTheGainInTheResidual) {
  const auto reference = late_motion(0);
  const auto found =
      fit_delay(reference, late_motion(0.0123, 0.9), kTrackingStep, kTrackingSearch, Gain::Fixed);

  double squares = 0;
  for (const double value : reference) squares += value * value;
  const double compared = 12'000 - 2 * (200 + 3);
  EXPECT_NEAR(found.delay, 0.0123, 1e-6);
  EXPECT_EQ(found.gain, 1);
  EXPECT_NEAR(found.residual_rms, 0.1 * std::sqrt(squares / compared), 1e-4);
}

std::vector<double> strong_part(const std::vector<double>& values) {
  return {values.begin() + 3'000, values.begin() + 9'000};
}

struct AddedNoise {
  double size, memory;
  friend std::ostream& operator<<(std::ostream& out, const AddedNoise& n) {
    return out << n.size << " memory " << n.memory;
  }
};
class NoisyDelay : public ::testing::TestWithParam<AddedNoise> {};

// 30 seeds at 95 %: fewer than 24 covered have a probability of 0.1 % (binomial).
TEST_P(NoisyDelay, LiesInItsIntervals) {
  constexpr unsigned kSeeds = 30;
  const auto reference = strong_part(late_motion(0));
  const auto late = strong_part(late_motion(0.0317, 0.95));
  int delays = 0, gains = 0, fixed = 0, indices = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const auto measured = with_noise(late, GetParam().size, GetParam().memory, seed);
    const auto found = fit_delay(reference, measured, kTrackingStep, 0.05);
    delays += std::abs(found.delay - 0.0317) < found.delay_95 ? 1 : 0;
    gains += std::abs(found.gain - 0.95) < found.gain_95 ? 1 : 0;
    const auto bare = fit_delay(reference, measured, kTrackingStep, 0.05, Gain::Fixed);
    fixed += std::abs(bare.delay - 0.0317) < bare.delay_95 ? 1 : 0;
    const auto index = frequency_index(reference, measured, kTrackingStep, 0.03);
    indices += std::abs(index.delay - 0.0317) < index.delay_95 ? 1 : 0;
    // Intervals that cover everything would say nothing.
    EXPECT_LT(found.delay_95, 0.004);
    EXPECT_LT(index.delay_95, 0.015);
  }

  EXPECT_GE(delays, 24);
  EXPECT_GE(gains, 24);
  EXPECT_GE(fixed, 24);
  EXPECT_GE(indices, 24);
}

INSTANTIATE_TEST_SUITE_P(Noises, NoisyDelay,
                         ::testing::Values(AddedNoise{0.02, 0}, AddedNoise{0.2, 0},
                                           AddedNoise{0.05, 0.9}));

// White noise of size s on m = g r(τ): the variance of τ is s²/(g² Σ r'²), a textbook result where
// r and r' are orthogonal.
TEST(Interval, IsThatOfTheTextbookForWhiteNoise) {
  const auto reference = late_motion(0);
  const auto found =
      fit_delay(reference, with_noise(late_motion(0.01), 0.1, 0, 5), kTrackingStep, 0.05);

  double rates = 0;
  for (std::size_t i = 1; i < reference.size(); ++i)
    rates += std::pow((reference[i] - reference[i - 1]) / kTrackingStep, 2);
  // The noise of 12,000 rows is known to 1 %; the sandwich of the score scatters by some percent.
  EXPECT_NEAR(found.delay_95, 1.96 * 0.1 / std::sqrt(rates), 0.1 * found.delay_95);
}

TEST(Windows, AreThoseInWhichTheReferenceMoves) {
  const auto reference = late_motion(0);
  const auto windows = moving_windows(reference, 2000, 0.2);

  ASSERT_FALSE(windows.empty());
  EXPECT_GE(windows.front().begin, 2000U);
  EXPECT_LE(windows.back().begin + windows.back().length, 11'000U);
  for (std::size_t i = 1; i < windows.size(); ++i)
    EXPECT_EQ(windows[i].begin - windows[i - 1].begin, 1000U);
  EXPECT_TRUE(moving_windows(reference, 2000, 10).empty());
}

TEST(Tracking, RefusesSignalsThatAreUnequalOrConstant) {
  const auto reference = late_motion(0);
  EXPECT_THROW(
      (void)fit_delay(reference, std::vector<double>(10, 1.0), kTrackingStep, kTrackingSearch),
      Error);
  EXPECT_THROW(
      (void)fit_delay(reference, std::vector<double>(12'000, 1.0), kTrackingStep, kTrackingSearch),
      Error);
  EXPECT_THROW((void)frequency_index(std::vector<double>(100, 1.0), std::vector<double>(100, 1.0),
                                     kTrackingStep, 0),
               Error);
  EXPECT_THROW((void)frequency_index(reference, std::vector<double>(3, 1.0), kTrackingStep, 0),
               Error);
}

// With white residuals and orthogonal columns the covariance is σ²/Σx².
TEST(RobustCovariance, IsThatOfOrdinaryLeastSquaresForWhiteResiduals) {
  constexpr Eigen::Index kRows = 20'000;
  std::mt19937 random{3};
  std::normal_distribution<double> normal{0, 2};
  Eigen::MatrixXd jacobian(kRows, 2);
  Eigen::VectorXd residual(kRows);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    jacobian(i, 0) = i % 2 == 0 ? 3 : -3;
    jacobian(i, 1) = 1e-6;
    residual[i] = normal(random);
  }

  const auto covariance = robust_covariance(jacobian, residual, 0);

  EXPECT_NEAR(covariance(0, 0), 4 / (9.0 * kRows), 0.05 * 4 / (9.0 * kRows));
  EXPECT_NEAR(covariance(1, 1), 4e12 / kRows, 0.05 * 4e12 / kRows);
  jacobian.col(1) = jacobian.col(0);
  EXPECT_THROW((void)robust_covariance(jacobian, residual, 0), Error);
}

}  // namespace
}  // namespace rths::maths
