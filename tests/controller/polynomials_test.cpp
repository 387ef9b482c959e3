// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include <rths/controller/polynomials.hpp>

#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

/// A polynomial family and the degree of motion that it must reproduce exactly.
struct Family {
  Polynomial polynomial;
  int predictor_degree, corrector_degree;
  friend std::ostream& operator<<(std::ostream& out, const Family& f) {
    return out << to_text(f.polynomial);
  }
};

constexpr Family kFamilies[] = {
    {Polynomial::P0, 0, 0}, {Polynomial::P1, 1, 1}, {Polynomial::P2, 2, 2},
    {Polynomial::P3, 3, 3}, {Polynomial::D1, 1, 1}, {Polynomial::D2, 2, 2},
    {Polynomial::D3, 3, 3}, {Polynomial::DV, 3, 2}, {Polynomial::DVA, 2, 3}};

/// Motion c₀ + c₁x + … of a given degree, with its rates.
struct PolynomialMotion {
  int degree;
  [[nodiscard]] double at(double x) const { return sum(x, 0); }
  [[nodiscard]] double rate(double x) const { return sum(x, 1); }
  [[nodiscard]] double second_rate(double x) const { return sum(x, 2); }

 private:
  [[nodiscard]] double sum(double x, int derivative) const {
    constexpr double kCoefficients[] = {0.7, -1.3, 2.1, -0.9};
    double total = 0;
    for (int power = derivative; power <= degree; ++power) {
      double factor = kCoefficients[power];
      for (int i = 0; i < derivative; ++i) factor *= power - i;
      total += factor * std::pow(x, power - derivative);
    }
    return total;
  }
};

/// The weighted sum for a motion sampled in a branch's frame.
Jet applied(const Weights& w, const PolynomialMotion& motion, Branch branch, double xi) {
  const double newest = branch == Branch::Predict ? 0 : 1;
  const double switch_at = branch == Branch::Predict ? xi - 1 : xi;
  Jet sum = w.switch_command * motion.at(switch_at) + w.acceleration * motion.second_rate(newest);
  for (std::size_t i = 0; i < w.target.size(); ++i)
    sum = sum + w.target[i] * motion.at(newest - static_cast<double>(i));
  for (std::size_t i = 0; i < w.velocity.size(); ++i)
    sum = sum + w.velocity[i] * motion.rate(newest - static_cast<double>(i));
  return sum;
}

class PolynomialFamily : public ::testing::TestWithParam<Family> {
 protected:
  // Rounding of a few dozen products of numbers around 10.
  static constexpr double kRounding = 1e-11;

  static void expect_reproduced(Branch branch, int degree, double xi) {
    const PolynomialMotion motion{degree};
    for (double x = branch == Branch::Predict ? 0.0 : xi; x <= 1.0; x += 0.05) {
      const Jet found = applied(weights(GetParam().polynomial, branch, x, xi), motion, branch, xi);
      EXPECT_NEAR(found.value, motion.at(x), kRounding) << "x " << x << " xi " << xi;
      EXPECT_NEAR(found.slope, motion.rate(x), kRounding) << "x " << x << " xi " << xi;
      EXPECT_NEAR(found.curvature, motion.second_rate(x), kRounding) << "x " << x << " xi " << xi;
    }
  }
};

TEST_P(PolynomialFamily, PredictsMotionOfItsDegreeExactly) {
  expect_reproduced(Branch::Predict, GetParam().predictor_degree, 1.0);
}

TEST_P(PolynomialFamily, CorrectsMotionOfItsDegreeExactlyFromAnywhereInTheStep) {
  for (const double xi : {0.0, 0.3, 0.6, 0.8})
    expect_reproduced(Branch::Correct, GetParam().corrector_degree, xi);
}

TEST_P(PolynomialFamily, EndsItsCorrectionAtTheTarget) {
  const Weights w = weights(GetParam().polynomial, Branch::Correct, 1.0, 0.4);

  EXPECT_NEAR(w.target[0].value, 1, kRounding);
  EXPECT_NEAR(w.target[1].value, 0, kRounding);
  EXPECT_NEAR(w.target[2].value, 0, kRounding);
  EXPECT_NEAR(w.target[3].value, 0, kRounding);
  EXPECT_NEAR(w.switch_command.value, 0, kRounding);
  EXPECT_NEAR(w.velocity[0].value, 0, kRounding);
  EXPECT_NEAR(w.acceleration.value, 0, kRounding);
}

TEST_P(PolynomialFamily, IsFoundByItsName) {
  EXPECT_EQ(polynomial_from_text(to_text(GetParam().polynomial)), GetParam().polynomial);
}

TEST_P(PolynomialFamily, EvaluatesInRealTime) {
  Weights w;
  EXPECT_REALTIME(w = weights(GetParam().polynomial, Branch::Correct, 0.5, 0.3));
  EXPECT_TRUE(std::isfinite(w.target[0].value));
}

INSTANTIATE_TEST_SUITE_P(All, PolynomialFamily, ::testing::ValuesIn(kFamilies),
                         [](const auto& f) { return std::string{to_text(f.param.polynomial)}; });

class CommandFamily : public ::testing::TestWithParam<Polynomial> {};

TEST_P(CommandFamily, StartsItsCorrectionAtTheCommand) {
  const double xi = 0.37;
  const Weights w = weights(GetParam(), Branch::Correct, xi, xi);

  EXPECT_NEAR(w.switch_command.value, 1, 1e-12);
  for (const Jet& target : w.target) EXPECT_NEAR(target.value, 0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(All, CommandFamily,
                         ::testing::Values(Polynomial::D1, Polynomial::D2, Polynomial::D3,
                                           Polynomial::DV, Polynomial::DVA),
                         [](const auto& p) { return std::string{to_text(p.param)}; });

// The D family's rates as written out in the charts, against our forward differentiation.
TEST(CubicCommandCorrector, HasTheChartsVelocityAndAcceleration) {
  const double x = 0.62;
  const double xi = 0.31;
  const Weights w = weights(Polynomial::D3, Branch::Correct, x, xi);

  EXPECT_NEAR(w.target[0].slope, (2 + 6 * x + 3 * x * x - 3 * xi - 2 * x * xi) / (6 * (1 - xi)),
              1e-12);
  EXPECT_NEAR(w.switch_command.slope, (1 - 4 * x - 3 * x * x) / ((1 - xi) * (1 + xi) * (2 + xi)),
              1e-12);
  EXPECT_NEAR(w.target[2].slope, -(2 - 2 * x - 3 * x * x + xi + 2 * x * xi) / (2 * (1 + xi)),
              1e-12);
  EXPECT_NEAR(w.target[3].slope, (1 - 3 * x * x + 2 * x * xi) / (3 * (2 + xi)), 1e-12);
  EXPECT_NEAR(w.target[0].curvature, (3 + 3 * x - xi) / (3 * (1 - xi)), 1e-12);
  EXPECT_NEAR(w.switch_command.curvature, -2 * (2 + 3 * x) / ((1 - xi) * (1 + xi) * (2 + xi)),
              1e-12);
  EXPECT_NEAR(w.target[2].curvature, (1 + 3 * x - xi) / (1 + xi), 1e-12);
  EXPECT_NEAR(w.target[3].curvature, -2 * (3 * x - xi) / (3 * (2 + xi)), 1e-12);
}

TEST(CubicCommandPredictor, HasTheChartsVelocityAndAcceleration) {
  const double x = 0.62;
  const double xi = 1.0;
  const Weights w = weights(Polynomial::D3, Branch::Predict, x, xi);

  EXPECT_NEAR(w.switch_command.slope, (11 + 12 * x + 3 * x * x) / (xi * (1 + xi) * (2 + xi)),
              1e-12);
  EXPECT_NEAR(w.target[1].slope, -(11 + 12 * x + 3 * x * x - 5 * xi - 2 * x * xi) / (2 * xi),
              1e-12);
  EXPECT_NEAR(w.target[2].slope, (7 + 10 * x + 3 * x * x - 4 * xi - 2 * x * xi) / (1 + xi), 1e-12);
  EXPECT_NEAR(w.target[3].slope, -(5 + 8 * x + 3 * x * x - 3 * xi - 2 * x * xi) / (2 * (2 + xi)),
              1e-12);
  EXPECT_NEAR(w.switch_command.curvature, 6 * (2 + x) / (xi * (1 + xi) * (2 + xi)), 1e-12);
  EXPECT_NEAR(w.target[1].curvature, -(6 + 3 * x - xi) / xi, 1e-12);
  EXPECT_NEAR(w.target[2].curvature, 2 * (5 + 3 * x - xi) / (1 + xi), 1e-12);
  EXPECT_NEAR(w.target[3].curvature, -(4 + 3 * x - xi) / (2 + xi), 1e-12);
}

TEST(Polynomial, IsNotFoundUnderAnUnknownName) {
  EXPECT_EQ(polynomial_from_text("D4"), std::nullopt);
}

}  // namespace
}  // namespace rths::controller
