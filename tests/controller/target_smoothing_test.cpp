// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/controller/target_smoothing.hpp>
#include <rths/core/error.hpp>

#include "support/files.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

constexpr TargetSmoothingSettings kAll{
    .period = kPeriod, .smoothing = 2.5e-3, .average = 0.01, .oil_column = 12};

/// The smoothed amplitude of a steady sine of amplitude 1.
double gain_at(double frequency, const TargetSmoothingSettings& settings) {
  TargetSmoothing smoothing{settings};
  double largest = 0;
  for (int i = 0; i < 8000; ++i) {
    smoothing.advance(std::sin(2 * std::numbers::pi * frequency * i * kPeriod));
    if (i > 4000) largest = std::max(largest, std::abs(smoothing.smoothed()[0]));
  }
  return largest;
}

/// Of five poles y += h/(h + T)(u − y), at z = exp(iωh).
double gain_of_poles(double frequency, double smoothing) {
  const double k = kPeriod / (kPeriod + smoothing), w = 2 * std::numbers::pi * frequency * kPeriod;
  return std::pow(k / std::hypot(1 - (1 - k) * std::cos(w), (1 - k) * std::sin(w)), 5);
}

class Smoothing : public ::testing::TestWithParam<TargetSmoothingSettings> {};

// The series in the backward difference D is exact up to D⁴, and D⁵ of x = t⁴ is zero.
TEST_P(Smoothing, LeavesMotionOfTheFourthOrderAsItIs) {
  TargetSmoothing smoothing{GetParam()};
  std::array<double, 5> past{};  // newest first
  for (int i = 0; i <= 2000; ++i) {
    const double t = i * kPeriod - 1;
    std::copy_backward(past.begin(), past.end() - 1, past.end());
    past[0] = 0.3 + t * (0.2 + t * (-0.5 + t * (0.7 + t)));
    smoothing.advance(past[0]);
  }

  const auto sharp = smoothing.sharpened(smoothing.smoothed());
  double binomial[5] = {1, 0, 0, 0, 0}, scale = 1;  // of Dᵏ
  for (int k = 0; k < 5; ++k, scale /= kPeriod) {
    double difference = 0;
    for (int j = 0; j <= k; ++j)
      difference += (j % 2 != 0 ? -1 : 1) * binomial[j] * past[static_cast<std::size_t>(j)];
    // Rounding: the difference has 2ᵏ ε h⁻ᵏ, and so do the poles.
    const double rounding = 1e-15 * std::pow(2 / kPeriod, k);
    EXPECT_NEAR(sharp[k], difference * scale, 1e-9 + 10 * rounding) << k;
    for (int j = 4; j > 0; --j) binomial[j] += binomial[j - 1];
  }
}

TEST_P(Smoothing, IsLateByItsDelay) {
  TargetSmoothing smoothing{GetParam()};
  const double speed = 0.5;
  for (int i = 0; i <= 2000; ++i) smoothing.advance(speed * i * kPeriod);
  const double expected = 2000 * kPeriod - smoothing.delay();
  EXPECT_NEAR(smoothing.smoothed()[0], speed * expected, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Each, Smoothing,
                         ::testing::Values(TargetSmoothingSettings{kPeriod, 2e-3, 0, 0},
                                           TargetSmoothingSettings{kPeriod, 2e-3, 0.01, 0},
                                           TargetSmoothingSettings{kPeriod, 2e-3, 0, 12}, kAll));

// Each target changes the command's slope, every 10 ms.
TEST(TargetSmoothing, RemovesAllMultiplesOfTheStepsOfATarget) {
  for (const double frequency : {100.0, 200.0, 300.0})
    EXPECT_LT(gain_at(frequency, kAll), 1e-9) << frequency;
}

TEST(TargetSmoothing, AttenuatesTheOilColumns) {
  TargetSmoothingSettings without = kAll;
  without.average = 0;
  // A tenth: the depth of the notch. The sampled sine may miss its peak by 1 − cos(πfT).
  const double expected = 0.1 * gain_of_poles(12, without.smoothing);
  EXPECT_NEAR(gain_at(12, without), expected, 1e-3 * expected);
}

TEST(TargetSmoothing, StartsAtRest) {
  TargetSmoothing smoothing{kAll};
  smoothing.advance(0.25);
  EXPECT_NEAR(smoothing.smoothed()[0], 0.25, 1e-12);
  EXPECT_NEAR(smoothing.sharpened(smoothing.smoothed())[0], 0.25, 1e-12);
  EXPECT_NEAR(smoothing.sharpened(smoothing.smoothed())[2], 0, 1e-6);
}

TEST(TargetSmoothing, RefusesSettingsOutOfRange) {
  const auto refused = [](const TargetSmoothingSettings& settings) {
    return test::error_of([&] { static_cast<void>(TargetSmoothing{settings}); });
  };
  EXPECT_EQ(refused({kPeriod, 0, 0, 0}),
            "adaptive inverse: smoothing is 0, expected a positive number");
  EXPECT_EQ(refused({kPeriod, 2e-3, 0.2, 0}),
            "adaptive inverse: average is 0.2, expected 0 to 0.1 s");
  EXPECT_EQ(refused({kPeriod, 2e-3, 0, 500}),
            "adaptive inverse: oil_column is 500, expected 0 to half of the sampling rate");
}

TEST(TargetSmoothing, WorksInRealTime) {
  TargetSmoothing smoothing{kAll};
  TargetSmoothing::Derivatives sharp;
  EXPECT_REALTIME(smoothing.advance(0.1); sharp = smoothing.sharpened(smoothing.smoothed()));
  EXPECT_TRUE(sharp.allFinite());
}

}  // namespace
}  // namespace rths::controller
