// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/least_squares.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr int kLeastSquaresRows = 400;

// y = a exp(-b t) + noise
struct Decay {
  VectorXd t = VectorXd::LinSpaced(kLeastSquaresRows, 0, 2), y;

  explicit Decay(unsigned seed, double deviation = 0.05) : y(kLeastSquaresRows) {
    std::mt19937 random{seed};
    std::normal_distribution<double> normal{0, deviation};
    for (int i = 0; i < kLeastSquaresRows; ++i)
      y[i] = 3e6 * std::exp(-1.5 * t[i]) + 1e6 * normal(random);
  }

  FitProblem problem() const {
    FitProblem p;
    p.residuals = [this](const VectorXd& x, VectorXd& residual, MatrixXd* jacobian) {
      const Eigen::ArrayXd e = (-x[1] * t.array()).exp();
      residual = (y.array() - x[0] * e) / 5e4;
      if (jacobian != nullptr) {
        jacobian->resize(kLeastSquaresRows, 2);
        jacobian->col(0) = -e / 5e4;
        jacobian->col(1) = x[0] * t.array() * e / 5e4;
      }
      return true;
    };
    p.rows = kLeastSquaresRows;
    p.start = VectorXd{{1e6, 0.2}};
    p.low = VectorXd::Constant(2, 0);
    p.high = VectorXd::Constant(2, kNone);
    p.scale = VectorXd{{1e6, 1}};
    return p;
  }
};

TEST(LeastSquares, FindsParametersOfAnySize) {
  const Fit fit = least_squares(Decay{1, 0}.problem());

  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.parameters[0], 3e6, 10);
  EXPECT_NEAR(fit.parameters[1], 1.5, 1e-5);
}

// As of a force that saturates at 1e15 N if the effect is absent.
TEST(LeastSquares, FindsTheOthersIfAScaleIsFarBeyondItsBounds) {
  const Decay decay{1, 0};
  FitProblem p = decay.problem();
  p.high[1] = 5;
  p.scale[1] = 1e15;

  const Fit fit = least_squares(p);

  EXPECT_NEAR(fit.parameters[0], 3e6, 10);
  EXPECT_NEAR(fit.parameters[1], 1.5, 1e-5);
}

TEST(LeastSquares, StaysInsideItsBounds) {
  const Decay decay{1};
  FitProblem p = decay.problem();
  p.high[1] = 1;

  const Fit fit = least_squares(p);

  EXPECT_NEAR(fit.parameters[1], 1, 1e-9);
  EXPECT_LT(fit.parameters[0], 3e6);
}

// y = (c + f) v forwards, (c + b) v backwards. Only two of the three parameters are determined; the
// bounds at zero select them. The fit takes no more iterations than a linear problem.
TEST(LeastSquares, FindsAMinimumOnABoundIfParametersAreNotDetermined) {
  const VectorXd v = VectorXd::LinSpaced(kLeastSquaresRows, -1, 1);
  FitProblem p;
  p.residuals = [&v](const VectorXd& x, VectorXd& residual, MatrixXd* jacobian) {
    const Eigen::ArrayXd forward = v.array().max(0), backward = v.array().min(0);
    residual = (170 - x[0] - x[1]) * forward + (245 - x[0] - x[2]) * backward;
    if (jacobian != nullptr) {
      jacobian->resize(kLeastSquaresRows, 3);
      jacobian->col(0) = -v;
      jacobian->col(1) = -forward;
      jacobian->col(2) = -backward;
    }
    return true;
  };
  p.rows = kLeastSquaresRows;
  p.start = VectorXd{{208, 5, 2}};
  p.low = VectorXd::Zero(3);
  p.high = VectorXd::Constant(3, kNone);
  p.scale = VectorXd{{20, 5, 2}};
  p.most_iterations = 6;

  const Fit fit = least_squares(p);

  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.parameters[0] + fit.parameters[1], 170, 1e-2);
  EXPECT_NEAR(fit.parameters[0] + fit.parameters[2], 245, 1e-2);
}

TEST(LeastSquares, StaysWhereAResidualExists) {
  const Decay decay{1, 0};
  FitProblem p = decay.problem();
  const Residuals everywhere = p.residuals;
  p.residuals = [&](const VectorXd& x, VectorXd& residual, MatrixXd* jacobian) {
    return x[1] < 1.6 && everywhere(x, residual, jacobian);
  };

  EXPECT_NEAR(least_squares(p).parameters[1], 1.5, 1e-4);
  p.start[1] = 2;
  EXPECT_EQ(test::error_of([&] { static_cast<void>(least_squares(p)); }),
            "least squares: no residual at the start");
}

TEST(LeastSquares, RefusesInvalidProblems) {
  const Decay decay{1};
  FitProblem p = decay.problem();
  p.start[0] = -1;

  EXPECT_EQ(test::error_of([&] { static_cast<void>(least_squares(p)); }),
            "least squares: the start lies outside the bounds");
}

// 95 % of 400 intervals, ± three standard deviations of that count.
TEST(Covariance, GivesIntervalsWithTheirStatedCoverage) {
  int inside = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const Decay decay{seed};
    const Fit fit = least_squares(decay.problem());
    const double deviation = std::sqrt(covariance(fit, 10)(1, 1));
    inside += std::abs(fit.parameters[1] - 1.5) <= 1.96 * deviation ? 1 : 0;
  }

  EXPECT_GE(inside, 366);
}

TEST(Covariance, ReportsParametersThatAreNotIdentifiable) {
  Fit fit;
  fit.jacobian = MatrixXd::Ones(10, 2);
  fit.residual = VectorXd::Ones(10);

  EXPECT_EQ(test::error_of([&] { static_cast<void>(covariance(fit, 2)); }),
            "covariance: the data do not separate the parameters");
}

}  // namespace
}  // namespace rths::diagnosis
