// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <rths/maths/fourier.hpp>

namespace rths::maths {
namespace {

constexpr double kTransformRounding = 1e-12;

Eigen::VectorXd signal_of_length(Eigen::Index length) {
  return Eigen::ArrayXd::LinSpaced(length, 0, 3).sin() + 0.25;
}

class LengthOfTransform : public testing::TestWithParam<Eigen::Index> {};

TEST_P(LengthOfTransform, GivesTheSumOfTheDefinition) {
  const auto length = GetParam();
  const Eigen::VectorXd x = signal_of_length(length);

  const Eigen::VectorXcd found = spectrum(x);

  for (Eigen::Index k = 0; k < length; ++k) {
    std::complex<double> sum = 0;
    for (Eigen::Index n = 0; n < length; ++n)
      sum += x[n] * std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k * n) /
                                        static_cast<double>(length));
    EXPECT_NEAR(std::abs(found[k] - sum), 0, kTransformRounding) << k;
  }
}

TEST_P(LengthOfTransform, IsKeptByTheInverse) {
  const Eigen::VectorXd x = signal_of_length(GetParam());

  EXPECT_NEAR((signal_of(spectrum(x)) - x).norm(), 0, kTransformRounding);
}

TEST_P(LengthOfTransform, HasHalfAsManyFrequenciesInAHalfSpectrum) {
  const Eigen::VectorXd x = signal_of_length(GetParam());

  EXPECT_EQ(half_spectrum(x), spectrum(x).head(GetParam() / 2 + 1));
}

INSTANTIATE_TEST_SUITE_P(EvenAndOdd, LengthOfTransform, testing::Values(5, 6, 8, 15));

TEST(FastLength, HasNoPrimeFactorAboveFive) {
  EXPECT_EQ(fast_length(1), 1);
  EXPECT_EQ(fast_length(7), 8);
  EXPECT_EQ(fast_length(121), 125);
}

TEST(HannWindow, IsSymmetricOrPeriodicByItsShift) {
  const Eigen::VectorXd symmetric = hann_window(8, 0.5), periodic = hann_window(8, 0);

  EXPECT_NEAR((symmetric - symmetric.reverse()).norm(), 0, kTransformRounding);
  EXPECT_EQ(periodic[0], 0);
  EXPECT_NEAR(periodic[4], 1, kTransformRounding);
}

}  // namespace
}  // namespace rths::maths
