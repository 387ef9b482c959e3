// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/intervals.hpp>

#include <cmath>

#include <gtest/gtest.h>

#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kIntervalRows = 400;
constexpr double kIntervalStep = 0.05, kIntervalNoise = 0.5;

LinearRelation relation_of_intervals() {
  LinearRelation relation;
  relation.deviation = {kIntervalNoise};
  return relation;
}

/// Records whose slopes may differ: y = slope x + noise. The ridge of the normal matrix changes
/// variances by 10⁻⁹.
struct Slopes {
  LinearRelation relation = relation_of_intervals();
  std::vector<Record> records;

  explicit Slopes(const std::vector<double>& slopes, double noise = 0, unsigned seed = 1) {
    const VectorXd x = sine_of(3, kIntervalRows);
    for (const double slope : slopes)
      records.push_back(linear_record(
          "record", Use::Fit, kIntervalStep,
          slope * x + noise * gauss(kIntervalRows, 1, seed + unsigned(records.size())),
          {{"x", x}}));
  }
};

std::vector<Estimate> intervals(const Problem& problem, const Hypothesis& fitted,
                                double inflation = 1) {
  return estimates_of(fitted, covariance_of(problem, whole({0}), fitted, inflation));
}

// ‖x‖² = 400, and the prediction 2 x has an error of up to kMaterial of its deviation.
const double kWhite = kIntervalNoise / std::sqrt(double(kIntervalRows));
const double kSystematic = 2 * kMaterial / std::sqrt(3.0);
double half_of(double ratio, double systematic = kSystematic) {
  return 1.96 * std::hypot(ratio * kWhite, systematic);
}
const double kHalf = half_of(1);

TEST(EstimatesOf, HaveTheIntervalOfLinearRegression) {
  const Slopes slopes{{2}};
  const Problem problem = linear_problem(slopes.relation, slopes.records);

  const auto estimates = intervals(problem, linear_model({"x"}, {2}));

  ASSERT_EQ(estimates.size(), 1U);
  EXPECT_EQ(estimates[0].name, "x");
  EXPECT_EQ(estimates[0].unit, "N");
  EXPECT_EQ(estimates[0].value, 2);
  EXPECT_NEAR(estimates[0].high - 2, kHalf, 1e-6 * kHalf);
  EXPECT_NEAR(2 - estimates[0].low, kHalf, 1e-6 * kHalf);
}

TEST(EstimatesOf, DoNotDependOnTheScaleOfAParameter) {
  const Slopes slopes{{2}};
  const Problem problem = linear_problem(slopes.relation, slopes.records);
  Hypothesis model = linear_model({"x"}, {2});
  model.free[0].scale = 1e4;

  EXPECT_NEAR(intervals(problem, model)[0].high - 2, kHalf, 1e-6 * kHalf);
}

TEST(EstimatesOf, AreAsWideAsTheInflationSays) {
  const Slopes slopes{{2}};
  const Problem problem = linear_problem(slopes.relation, slopes.records);

  EXPECT_NEAR(intervals(problem, linear_model({"x"}, {2}), 3)[0].high - 2, half_of(3),
              1e-6 * kHalf);
}

// A residual of three times the noise, orthogonal to x and alternating: it has no sum over blocks.
// The measurement has the deviation √(2² + 1.5²) = 2.5.
TEST(EstimatesOf, GrowWithTheMeanSquareOfTheResidual) {
  Slopes slopes{{2}};
  auto& measured = slopes.records[0].channels[0].values;
  for (std::size_t i = 0; i < measured.size(); ++i)
    measured[i] += (i % 2 == 0 ? 3 : -3) * kIntervalNoise;
  const Problem problem = linear_problem(slopes.relation, slopes.records);

  EXPECT_NEAR(intervals(problem, linear_model({"x"}, {2}))[0].high - 2,
              half_of(3, kSystematic * 2.5 / 2), 1e-6 * kHalf);
}

TEST(EstimatesOf, EndAtTheBounds) {
  const Slopes slopes{{2}};
  const Problem problem = linear_problem(slopes.relation, slopes.records);
  Hypothesis model = linear_model({"x"}, {2});
  model.free[0].low = 1.99;

  const Estimate inside = intervals(problem, model)[0];
  EXPECT_EQ(inside.low, 1.99);
  EXPECT_NEAR(inside.high - 2, kHalf, 1e-6 * kHalf);

  model.free[0].low = 2;
  const Estimate on_bound = intervals(problem, model)[0];
  EXPECT_EQ(on_bound.low, 2);
  EXPECT_NEAR(on_bound.high - 2, kHalf, 1e-6 * kHalf);
}

// Of 200 intervals with 95 % coverage, 181 to 199 contain the truth: three deviations of
// √(200 · 0.95 · 0.05). The larger of two estimates of the variance makes them wider, not narrower.
TEST(EstimatesOf, HaveTheirStatedCoverage) {
  int held = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Slopes slopes{{2}, kIntervalNoise, seed};
    const Problem problem = linear_problem(slopes.relation, slopes.records);
    const Hypothesis fit = fitted(problem, linear_model({"x"}, {0}), whole({0}), kLongFit);
    const Estimate x = intervals(problem, fit)[0];
    held += x.low <= 2 && 2 <= x.high ? 1 : 0;
  }

  EXPECT_GE(held, 181);
  EXPECT_LE(held, 198);
}

/// A candidate of two parameters with given distances from zero, of unit variance and a
/// correlation.
struct Pair {
  Candidate candidate = friction("x");
  Hypothesis fitted;
  Eigen::Matrix2d covariance;

  Pair(double x, double y, double correlation)
      : fitted{linear_model({"x.coefficient", "y"}, {x, y})} {
    candidate.frees.push_back(size_parameter("y"));
    covariance << 1, correlation, correlation, 1;
  }
  [[nodiscard]] bool may_be_absent() const {
    return diagnosis::may_be_absent(candidate, fitted, covariance);
  }
};

// The 95 % quantile of chi-square is 1.960² = 3.841 of one degree of freedom.
TEST(MayBeAbsent, IsTheIntervalOfOneSize) {
  const Candidate one = friction("x");
  const Eigen::MatrixXd variance = Eigen::MatrixXd::Constant(1, 1, 4);

  EXPECT_TRUE(may_be_absent(one, linear_model({"x.coefficient"}, {2 * 1.95}), variance));
  EXPECT_FALSE(may_be_absent(one, linear_model({"x.coefficient"}, {-2 * 1.97}), variance));
}

TEST(MayBeAbsent, MeasuresFromTheValueOfNoEffect) {
  Candidate gain = friction("x");
  gain.frees[0].absent = 1;
  const Eigen::MatrixXd variance = Eigen::MatrixXd::Constant(1, 1, 1);

  EXPECT_TRUE(may_be_absent(gain, linear_model({"x.coefficient"}, {2.9}), variance));
  EXPECT_FALSE(may_be_absent(gain, linear_model({"x.coefficient"}, {-1}), variance));
}

// 5.991 of two degrees: without correlation x² + y²; 2·1.72² = 5.92 and 2·1.74² = 6.06.
TEST(MayBeAbsent, AddsIndependentSizes) {
  EXPECT_TRUE((Pair{1.72, 1.72, 0}.may_be_absent()));
  EXPECT_FALSE((Pair{1.74, -1.74, 0}.may_be_absent()));
  EXPECT_TRUE((Pair{2.4, 0, 0}.may_be_absent()));
}

// (x² - 2 ρ x y + y²)/(1 - ρ²) with x = y = 1: 2/(1 + ρ). Each interval includes zero.
TEST(MayBeAbsent, KnowsTheCorrelationOfSizes) {
  EXPECT_FALSE((Pair{1, 1, -0.67}.may_be_absent()));  // 6.06
  EXPECT_TRUE((Pair{1, 1, -0.66}.may_be_absent()));   // 5.88
  EXPECT_TRUE((Pair{1, 1, 0.67}.may_be_absent()));
}

// A shape widens the interval of its size: x²/(1 - ρ²) is left at a known shape.
TEST(MayBeAbsent, DoesNotCountTheErrorOfAShape) {
  Pair strength_and_exponent{1, 50, 0.9};
  strength_and_exponent.candidate.frees[1].absent.reset();
  EXPECT_TRUE(strength_and_exponent.may_be_absent());  // 1/0.19 = 5.26

  Pair more{1.1, 50, 0.9};
  more.candidate.frees[1].absent.reset();
  EXPECT_FALSE(more.may_be_absent());  // 6.37
}

TEST(MayBeAbsent, IsFalseWithoutASize) {
  Candidate shape = friction("x");
  shape.frees[0].absent.reset();

  EXPECT_FALSE(may_be_absent(shape, linear_model({"x.coefficient"}, {0}),
                             Eigen::MatrixXd::Constant(1, 1, 1)));
}

// y = c x + f max(x, 0) + b min(x, 0): the same as c + 1, f - 1 and b - 1, so that only f - b is
// determined. With ‖max(x, 0)‖² = 200, its deviation is 0.5 (2/200)^½ = 0.05.
TEST(MayBeAbsent, KnowsADifferenceWithoutKnowingTheSizes) {
  const VectorXd x = sine_of(3, kIntervalRows), forward = x.cwiseMax(0), back = x.cwiseMin(0);
  Candidate halves = friction("x");
  halves.frees.push_back(size_parameter("y"));
  for (const auto& [backward, is_absent] : {std::pair{1.01, false}, {0.03, true}}) {
    const LinearRelation relation = relation_of_intervals();
    const std::vector<Record> records{
        linear_record("record", Use::Fit, kIntervalStep, x + 0.01 * forward + backward * back,
                      {{"whole", x}, {"x.coefficient", forward}, {"y", back}})};
    const Problem problem = linear_problem(relation, records);
    const Hypothesis fitted = linear_model({"whole", "x.coefficient", "y"}, {1, 0.01, backward});

    const auto covariance = covariance_of(problem, whole({0}), fitted);
    EXPECT_EQ(may_be_absent(halves, fitted, covariance), is_absent) << backward;
  }
}

/// y = x + (0.8 x + 0.6 z) of two correlated signals, ‖x‖² = 400.
struct Correlated {
  LinearRelation relation = relation_of_intervals();
  VectorXd x = sine_of(3, kIntervalRows), y = 0.8 * x + 0.6 * sine_of(5, kIntervalRows);
  std::vector<Record> records{
      linear_record("record", Use::Fit, kIntervalStep, x + y, {{"x", x}, {"y", y}})};
  Problem problem = linear_problem(relation, records);
  Hypothesis model = linear_model({"x", "y"}, {1, 1});
  // σ² (XᵀX)⁻¹ in white noise. The own effect of each parameter is 0.6 times its signal, and the
  // deviation of x + y is √3.6.
  double variance = kIntervalNoise * kIntervalNoise / (kIntervalRows * (1 - 0.64)) +
                    3.6 * std::pow(kMaterial / 0.6, 2) / 3;
};

TEST(CovarianceOf, HasTheCorrelationOfLinearRegression) {
  const Correlated signals;

  const Eigen::MatrixXd covariance = covariance_of(signals.problem, whole({0}), signals.model);

  EXPECT_NEAR(covariance(0, 0), signals.variance, 1e-6 * signals.variance);
  EXPECT_NEAR(covariance(0, 1), -0.8 * signals.variance, 1e-6 * signals.variance);
}

// The other signal could take the place of the one that its bound holds.
TEST(CovarianceOf, OfAParameterOnItsBoundIsThatWithoutTheBound) {
  Correlated signals;
  signals.model.free[0].low = 1;
  const double white = kIntervalNoise * kIntervalNoise / (kIntervalRows * (1 - 0.64));

  const Eigen::MatrixXd covariance = covariance_of(signals.problem, whole({0}), signals.model);

  EXPECT_NEAR(covariance(0, 0), white, 1e-4 * white);
  EXPECT_NEAR(covariance(1, 1), (1 - 0.64) * white, 1e-4 * white);
  EXPECT_NEAR(covariance(0, 1), 0, 1e-4 * white);
}

// A bound of 10¹² does not make 2 small.
TEST(CovarianceOf, DoesNotDependOnAFarBound) {
  const Slopes slopes{{2}};
  const Problem problem = linear_problem(slopes.relation, slopes.records);
  Hypothesis model = linear_model({"x"}, {2});
  model.free[0].low = 0;
  model.free[0].high = 1e12;

  const Estimate x = intervals(problem, model)[0];

  EXPECT_NEAR(2 - x.low, kHalf, 1e-6 * kHalf);
}

// Noise of deviation δ in x, whose mean square is 1, weakens the slope by δ²/(1 + δ²) of itself
// (attenuation). It also adds the noise 2 δ to the residual.
TEST(CovarianceOf, IncludesTheBiasByNoiseInTheMotion) {
  constexpr double kMotionNoise = 0.1;
  Slopes slopes{{2}};
  slopes.relation.motion_noise = kMotionNoise;
  Problem problem = linear_problem(slopes.relation, slopes.records);
  const Hypothesis model = linear_model({"x"}, {2});
  problem.renew_noise(model);

  const double variance = covariance_of(problem, whole({0}), model)(0, 0);

  const double square = kMotionNoise * kMotionNoise;
  const double white = (kIntervalNoise * kIntervalNoise + 4 * square) / kIntervalRows;
  const double bias = 2 * square / (1 + square);
  const double expected = white + bias * bias + kSystematic * kSystematic;
  EXPECT_NEAR(variance, expected, 1e-6 * expected);
}

// The difference of two slopes over its deviation in white noise.
TEST(FoldDisagreement, IsTheDifferenceOverItsDeviation) {
  const double deviation = kIntervalNoise * std::sqrt(2.0 / kIntervalRows);
  for (const double difference : {0.1, 0.2, -1.0}) {
    const Slopes slopes{{2, 2 + difference}};
    const Problem problem = linear_problem(slopes.relation, slopes.records);
    const Hypothesis mean = linear_model({"x"}, {2 + difference / 2});

    EXPECT_NEAR(fold_disagreement(problem, two_records(), mean), std::abs(difference) / deviation,
                1e-6 * std::abs(difference) / deviation);
  }
}

TEST(FoldDisagreement, IsOneOfEqualSlopes) {
  const Slopes slopes{{2, 2}};
  const Problem problem = linear_problem(slopes.relation, slopes.records);

  EXPECT_EQ(fold_disagreement(problem, two_records(), linear_model({"x"}, {2})), 1);
}

TEST(FoldDisagreement, IsOneOfAModelWithoutParameters) {
  const Slopes slopes{{2, 3}};
  const Problem problem = linear_problem(slopes.relation, slopes.records);

  EXPECT_EQ(fold_disagreement(problem, two_records(), slopes.relation.stated), 1);
  EXPECT_TRUE(intervals(problem, slopes.relation.stated).empty());
}

// In noise the ratio z is a standard normal number, and max(1, z²) has the mean 1 + 2 φ(1) = 1.484
// and the deviation 1.170.
TEST(FoldDisagreement, IsThatOfAUnitDeviationInNoise) {
  constexpr int kPairs = 100;
  double square = 0;
  for (unsigned seed = 1; seed <= kPairs; ++seed) {
    const Slopes slopes{{2, 2}, kIntervalNoise, 2 * seed};
    const Problem problem = linear_problem(slopes.relation, slopes.records);
    const Hypothesis fit = fitted(problem, linear_model({"x"}, {0}), whole({0, 1}), kLongFit);
    square += std::pow(fold_disagreement(problem, two_records(), fit), 2) / kPairs;
  }

  EXPECT_NEAR(square, 1.484, 3 * 1.17 / std::sqrt(kPairs));
}

}  // namespace
}  // namespace rths::diagnosis
