// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/controller/filters.hpp>
#include <rths/core/error.hpp>

#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

TEST(MovingAverage, IsTheMeanOfTheSamplesSoFar) {
  MovingAverage average{3};

  EXPECT_DOUBLE_EQ(average(3), 3);
  EXPECT_DOUBLE_EQ(average(5), 4);
  EXPECT_DOUBLE_EQ(average(7), 5);
  EXPECT_DOUBLE_EQ(average(9), 7);
}

TEST(EndSlope, HasNoLagForMotionOfConstantAcceleration) {
  EndSlope slope{32, kPeriod};
  for (int i = 0; i < 200; ++i) {
    const double t = i * kPeriod;
    const double found = slope(0.1 + 0.5 * t - 2 * t * t);
    if (i >= 31) {
      EXPECT_NEAR(found, 0.5 - 4 * t, 1e-9);
    }
  }
}

// Bilinear, pre-warped: with r = tan(πfT)/tan(πf₀T), the gain is that of the analogue filter at r.
TEST(Notch, AttenuatesItsFrequencyAlone) {
  constexpr double kFrequency = 12, kDamping = 0.4, kDepth = 0.1;
  for (const double frequency : {3.0, 9.0, 12.0, 20.0, 80.0}) {
    Notch notch{kFrequency, kDamping, kDepth, kPeriod};
    double largest = 0;
    for (int i = 0; i < 6000; ++i) {
      const double out = notch(std::sin(2 * std::numbers::pi * frequency * i * kPeriod));
      if (i > 3000) largest = std::max(largest, std::abs(out));
    }
    const double r = std::tan(std::numbers::pi * frequency * kPeriod) /
                     std::tan(std::numbers::pi * kFrequency * kPeriod);
    const double expected =
        std::hypot(1 - r * r, 2 * kDepth * kDamping * r) / std::hypot(1 - r * r, 2 * kDamping * r);
    // The sampled sine may miss its peak by 1 − cos(πfT).
    const double missed = 1 - std::cos(std::numbers::pi * frequency * kPeriod);
    EXPECT_NEAR(largest, expected, missed * expected + 1e-6) << frequency;
  }
}

TEST(Notch, StartsAtRest) {
  Notch notch{12, 0.4, 0.1, kPeriod};
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(notch(2.5), 2.5, 1e-12);
}

TEST(Notch, RefusesValuesOutOfRange) {
  EXPECT_THROW((Notch{500, 0.4, 0.1, kPeriod}), Error);
  EXPECT_THROW((Notch{0, 0.4, 0.1, kPeriod}), Error);
  EXPECT_THROW((Notch{12, 0, 0.1, kPeriod}), Error);
  EXPECT_THROW((Notch{12, 0.4, 1.1, kPeriod}), Error);
}

TEST(EndSlope, IsZeroUntilItHasEnoughSamples) {
  EndSlope slope{8, kPeriod};
  for (int i = 0; i < 7; ++i) EXPECT_EQ(slope(i), 0);
  EXPECT_NEAR(slope(7), 1 / kPeriod, 1e-6);
}

TEST(Filters, WorkInRealTime) {
  Notch notch{12, 0.4, 0.1, kPeriod};
  MovingAverage average{7};
  EndSlope slope{32, kPeriod};
  double sum = 0;
  for (int i = 0; i < 40; ++i)
    EXPECT_REALTIME(sum += notch(0.1 * i) + average(0.1 * i) + slope(0.1 * i));
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace rths::controller
