// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/maths/delay.hpp>

#include "support/files.hpp"

namespace rths::maths {
namespace {

constexpr double kStep = 0.001;

std::vector<double> motion(double delay, double gain = 1, double noise = 0) {
  std::mt19937 random{11};
  std::normal_distribution<double> normal{0, 1};
  std::vector<double> values;
  for (int i = 0; i < 20'000; ++i) {
    const double t = i * kStep - delay;
    const double envelope = std::exp(-std::pow((t - 10) / 4, 2));
    values.push_back(gain * envelope *
                         (std::sin(2 * std::numbers::pi * 0.7 * t) +
                          0.4 * std::sin(2 * std::numbers::pi * 1.9 * t)) +
                     noise * normal(random));
  }
  return values;
}

class KnownDelay : public ::testing::TestWithParam<double> {};

TEST_P(KnownDelay, IsFoundByBothMethodsBetweenTheSamples) {
  const auto found = identify_delay(motion(0), motion(GetParam()), kStep, 0.2);

  // The parabola through three samples of a smooth peak errs by far less than a sample.
  EXPECT_NEAR(found.cross_correlation, GetParam(), 2e-5);
  EXPECT_NEAR(found.minimum_rms, GetParam(), 2e-5);
}

INSTANTIATE_TEST_SUITE_P(Delays, KnownDelay,
                         ::testing::Values(0.0, 0.0601, 0.0043, 0.0127, -0.0208, 0.15));

TEST(Delay, IsFoundThroughNoise) {
  const auto found = identify_delay(motion(0), motion(0.06, 1, 0.02), kStep, 0.2);

  EXPECT_NEAR(found.cross_correlation, 0.06, 1e-3);
  EXPECT_NEAR(found.minimum_rms, 0.06, 1e-3);
}

TEST(Delay, DoesNotDependOnTheGain) {
  const auto found = identify_delay(motion(0), motion(0.06, 0.8), kStep, 0.2);

  EXPECT_NEAR(found.cross_correlation, 0.06, 2e-5);
}

// Cross-correlation compares shapes; minimum RMS compares values.
TEST(Delay, DiffersBetweenTheMethodsWhereTheShapesDiffer) {
  auto reference = motion(0);
  auto measured = motion(0.05);
  for (std::size_t i = 0; i < measured.size(); ++i) measured[i] += 0.3 * reference[i];

  const auto found = identify_delay(reference, measured, kStep, 0.2);

  EXPECT_GT(std::abs(found.cross_correlation - found.minimum_rms), 1e-5);
}

TEST(Delay, RefusesSignalsItCannotCompare) {
  const std::vector<double> still(2000, 1.0);
  const std::vector<double> brief(100, 1.0);

  EXPECT_EQ(test::error_of([&] { static_cast<void>(identify_delay(still, still, kStep, 0.2)); }),
            "delay: a signal is constant");
  EXPECT_NE(test::error_of([&] { static_cast<void>(identify_delay(still, brief, kStep, 0.2)); }),
            "");
  EXPECT_NE(test::error_of([&] { static_cast<void>(identify_delay(brief, brief, kStep, 0.2)); }),
            "");
}

TEST(TrackingError, IsMeasuredAgainstTheLargestReference) {
  const std::vector<double> reference = {0, 2, -4, 2};
  const std::vector<double> measured = {0, 2, -4, 4};

  const auto error = tracking_error(reference, measured);

  EXPECT_DOUBLE_EQ(error.rms, 1);
  EXPECT_DOUBLE_EQ(error.nrms, 0.25);
  EXPECT_DOUBLE_EQ(error.peak, 0.5);
}

}  // namespace
}  // namespace rths::maths
