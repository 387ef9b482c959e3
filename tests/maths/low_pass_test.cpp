// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include <rths/maths/low_pass.hpp>

#include "support/files.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::maths {
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

TEST(LowPass, WorksInRealTime) {
  LowPass filter{6, 20, kPeriod};
  std::array<std::array<double, 4>, 8> four{};
  double sum = 0;

  EXPECT_REALTIME(filter.filter_four(four));
  for (int i = 0; i < 40; ++i) EXPECT_REALTIME(sum += filter(0.1 * i));

  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace rths::maths
