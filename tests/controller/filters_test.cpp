// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <rths/controller/filters.hpp>
#include <rths/core/error.hpp>

#include "support/files.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

// Steady-state amplitude of a filtered sine.
double gain_at(int order, double cutoff, double frequency) {
  LowPass filter{order, cutoff, kPeriod};
  double largest = 0;
  for (int i = 0; i < 6000; ++i) {
    const double out = filter(std::sin(2 * std::numbers::pi * frequency * i * kPeriod));
    if (i > 3000) largest = std::max(largest, std::abs(out));
  }
  return largest;
}

class ButterworthOrder : public ::testing::TestWithParam<int> {};

// |H|² = 1/(1 + (tan(πfT)/tan(πf_cT))^2n), the bilinear image of the Butterworth response.
TEST_P(ButterworthOrder, HasTheButterworthGain) {
  const double cutoff = 20;
  for (const double frequency : {2.0, 10.0, 20.0, 30.0}) {
    const double ratio = std::tan(std::numbers::pi * frequency * kPeriod) /
                         std::tan(std::numbers::pi * cutoff * kPeriod);
    const double expected = 1 / std::sqrt(1 + std::pow(ratio, 2 * GetParam()));
    // The sampled sine may miss its peak by 1 − cos(πfT).
    EXPECT_NEAR(gain_at(GetParam(), cutoff, frequency), expected, 0.005 * expected + 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Even, ButterworthOrder, ::testing::Values(2, 4, 6, 8));

TEST(LowPass, PassesAConstantUnchanged) {
  LowPass filter{6, 20, kPeriod};
  double out = 0;
  for (int i = 0; i < 3000; ++i) out = filter(2.5);
  EXPECT_NEAR(out, 2.5, 1e-9);
}

TEST(LowPass, FiltersASignalAsSampleBySample) {
  for (const int order : {2, 4, 6, 8}) {
    LowPass whole{order, 20, kPeriod}, pieces = whole, single = whole;
    std::vector<double> signal(200);
    for (std::size_t i = 0; i < signal.size(); ++i)
      signal[i] = std::sin(0.3 * static_cast<double>(i));
    auto by_pieces = signal, by_samples = signal;

    whole.filter(signal);
    pieces.filter(std::span{by_pieces}.first(77));
    pieces.filter(std::span{by_pieces}.subspan(77));
    for (double& sample : by_samples) sample = single(sample);

    EXPECT_EQ(signal, by_samples) << order;
    EXPECT_EQ(by_pieces, by_samples) << order;
  }
}

TEST(LowPass, FiltersFourSignalsAsEachAlone) {
  for (const int order : {2, 4, 6, 8}) {
    const LowPass filter{order, 20, kPeriod};
    std::vector<std::array<double, 4>> together(300);
    for (std::size_t k = 0; k < together.size(); ++k)
      for (std::size_t i = 0; i < 4; ++i)
        together[k][i] = std::sin(0.1 * static_cast<double>(k * (i + 1))) + static_cast<double>(i);
    const auto inputs = together;

    filter.filter_four(together);

    for (std::size_t i = 0; i < 4; ++i) {
      LowPass alone = filter;
      for (std::size_t k = 0; k < together.size(); ++k)
        ASSERT_EQ(together[k][i], alone(inputs[k][i])) << order << ", " << i << ", " << k;
    }
  }
}

TEST(LowPass, RefusesSettingsOutOfRange) {
  EXPECT_NE(test::error_of([] { LowPass(3, 20, kPeriod); }), "");
  EXPECT_NE(test::error_of([] { LowPass(2, 500, kPeriod); }), "");
  EXPECT_NE(test::error_of([] { LowPass(2, -1, kPeriod); }), "");
}

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
  LowPass low_pass{6, 20, kPeriod};
  Notch notch{12, 0.4, 0.1, kPeriod};
  MovingAverage average{7};
  EndSlope slope{32, kPeriod};
  std::array<std::array<double, 4>, 8> four{};
  EXPECT_REALTIME(low_pass.filter_four(four));
  double sum = 0;
  for (int i = 0; i < 40; ++i)
    EXPECT_REALTIME(sum += low_pass(0.1 * i) + notch(0.1 * i) + average(0.1 * i) + slope(0.1 * i));
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace rths::controller
