// SPDX-License-Identifier: Apache-2.0
// Decompositions against their defining equations. Tolerances: the condition number of the matrices
// is below 1e3, so errors stay below 1e3 times the rounding of a double, 2.2e-16.
#include <rths/maths/decompositions.hpp>

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Core>

namespace rths::maths {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRounding = 1e-12;

MatrixXd rectangle() {
  MatrixXd a(5, 3);
  a << 1, 2, 0, -1, 3, 1, 4, 0, 2, 0.5, -2, 1, 1, 1, 1;
  return a;
}

MatrixXd positive() { return rectangle().transpose() * rectangle(); }

TEST(SymmetricFactors, SolveAndInvert) {
  const VectorXd b = VectorXd::LinSpaced(3, 1, 3);
  const SymmetricFactors factors{positive()};

  EXPECT_LT((positive() * factors.solve(b) - b).norm(), kRounding);
  EXPECT_LT((positive() * factors.inverse() - MatrixXd::Identity(3, 3)).norm(), kRounding);
  EXPECT_TRUE(factors.is_positive_definite());
}

TEST(SymmetricFactors, TellWhetherAMatrixIsPositiveDefinite) {
  MatrixXd indefinite = positive();
  indefinite(1, 1) = -1;
  MatrixXd singular = MatrixXd::Zero(2, 2);
  singular(0, 0) = 1;
  const MatrixXd undefined = MatrixXd::Constant(2, 2, std::numeric_limits<double>::quiet_NaN());

  EXPECT_FALSE(SymmetricFactors{indefinite}.is_positive_definite());
  EXPECT_FALSE(SymmetricFactors{singular}.is_positive_definite());
  EXPECT_EQ(SymmetricFactors{singular}.smallest_pivot(), 0);
  EXPECT_FALSE(SymmetricFactors{undefined}.is_positive_definite());
}

TEST(Solvers, SatisfyTheirEquations) {
  const VectorXd b = VectorXd::LinSpaced(3, -1, 4), tall = VectorXd::LinSpaced(5, 0, 2);
  const MatrixXd sides = MatrixXd::Identity(3, 2), tall_sides = MatrixXd::Identity(5, 2);

  EXPECT_LT((positive() * solve_symmetric(positive(), b) - b).norm(), kRounding);
  EXPECT_LT((positive() * solve_symmetric(positive(), sides) - sides).norm(), kRounding);
  EXPECT_LT((positive() * inverse(positive()) - MatrixXd::Identity(3, 3)).norm(), kRounding);
  // The residual of a least-squares solution is orthogonal to the columns.
  const MatrixXd a = rectangle();
  EXPECT_LT((a.transpose() * (a * solve_least_squares(a, tall) - tall)).norm(), kRounding);
  EXPECT_LT((a.transpose() * (a * solve_least_squares(a, tall_sides) - tall_sides)).norm(),
            kRounding);
}

TEST(MinimumNormSolver, FindsTheShortestSolutionOfADeficientSystem) {
  MatrixXd a = MatrixXd::Zero(3, 2);
  a.col(0) << 1, 1, 1;
  a.col(1) = a.col(0);
  const VectorXd b = VectorXd::Constant(3, 4);

  const MinimumNormSolver solver{a};

  // x₁ + x₂ = 4 has the shortest solution (2, 2).
  EXPECT_EQ(solver.rank(), 1);
  EXPECT_LT((solver.solve(b) - VectorXd::Constant(2, 2)).norm(), kRounding);
  EXPECT_LT((solver.pseudo_inverse() * b - VectorXd::Constant(2, 2)).norm(), kRounding);
}

TEST(MinimumNormSolver, IgnoresPivotsBelowItsThreshold) {
  MatrixXd a = MatrixXd::Identity(2, 2);
  a(1, 1) = 1e-7;

  EXPECT_EQ(MinimumNormSolver(a).rank(), 2);
  EXPECT_EQ(MinimumNormSolver(a, 1e-6).rank(), 1);
}

TEST(Modes, AreOrthogonalAndInRisingOrder) {
  const MatrixXd k = positive();
  const MatrixXd m = VectorXd::LinSpaced(3, 1, 3).asDiagonal();

  const Modes own = symmetric_modes(k), general = generalized_modes(k, m);

  const MatrixXd residual =
      k * general.vectors - m * general.vectors * general.values.asDiagonal().toDenseMatrix();
  EXPECT_LT((k - own.vectors * own.values.asDiagonal() * own.vectors.transpose()).norm(), 1e-11);
  EXPECT_LT(residual.norm(), 1e-11);
  EXPECT_LT((general.vectors.transpose() * m * general.vectors - MatrixXd::Identity(3, 3)).norm(),
            kRounding);
  EXPECT_LE(own.values[0], own.values[1]);
  EXPECT_LE(general.values[1], general.values[2]);
}

TEST(Exponential, OfARotationIsCosineAndSine) {
  MatrixXd rotation(2, 2);
  rotation << 0, -0.7, 0.7, 0;

  const MatrixXd turned = exponential(rotation);

  EXPECT_NEAR(turned(0, 0), std::cos(0.7), kRounding);
  EXPECT_NEAR(turned(1, 0), std::sin(0.7), kRounding);
}

}  // namespace
}  // namespace rths::maths
