// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/problem.hpp>

#include <cmath>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "identification/linear_relation.hpp"
#include "support/files.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEighth = 0.125;  // [s]: 8 rows in a block of 1 s

TEST(TestedHypothesis, DividesResidualAndDerivativesByTheNoise) {
  LinearRelation relation{{"N", "m"}};
  relation.deviation = {0.5, 20};
  MatrixXd x(100, 2);
  x << sine_of(3, 100), 40 * sine_of(4, 100);
  const std::vector<Record> records{linear_record("one", Use::Fit, kEighth, 3 * x, {{"x", x}})};
  const Problem problem = linear_problem(relation, records);
  const TestedHypothesis tested{problem, linear_model({"x"}, {1})};
  const VectorXd white = (VectorXd(200) << x.col(0) / 0.5, x.col(1) / 20).finished();
  VectorXd residual;
  MatrixXd jacobian;

  ASSERT_TRUE(tested.evaluate(whole({0}), tested.hypothesis().values, {0}, residual, jacobian));

  EXPECT_LT((residual - 2 * white).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((jacobian.col(0) + white).cwiseAbs().maxCoeff(), 1e-12);
  // Mean squares 4/0.25 and 4 · 1600/400.
  EXPECT_NEAR(tested.variance(whole({0})), 16, 1e-10);
}

TEST(TestedHypothesis, TakesValuesWithinTheirBounds) {
  LinearRelation relation;
  const std::vector<Record> records{linear_record("one", Use::Fit, kEighth, sine_of(3, 100), {})};
  const Problem problem = linear_problem(relation, records);
  Hypothesis model = linear_model({"x", "y"}, {-3, 9});
  model.free[0].low = -1;
  model.free[1].high = 2;

  EXPECT_EQ((TestedHypothesis{problem, model}.hypothesis().values), (VectorXd{{-1, 2}}));
}

// The last of the blocks has the four rows that remain.
TEST(TestedHypothesis, SumsHalfSquaresOfEverySecond) {
  LinearRelation relation{{"N", "N"}};
  relation.deviation = {2, 2};
  MatrixXd ramp(100, 2);
  ramp << VectorXd::LinSpaced(100, 0, 99), VectorXd::Constant(100, 6);
  const std::vector<Record> records{linear_record("one", Use::Fit, kEighth, ramp, {})};
  const Problem problem = linear_problem(relation, records);

  const auto blocks = TestedHypothesis{problem, relation.stated}.blocks(whole({0}));

  ASSERT_EQ(blocks.size(), 13U);
  for (int block = 0; block < 13; ++block) {
    double half = 0;
    for (int row = 8 * block; row < std::min(100, 8 * block + 8); ++row)
      half += (row * row + 36) / 4.0 / 2;
    EXPECT_NEAR(blocks[static_cast<std::size_t>(block)], half, 1e-9) << block;
  }
}

// Also of rows so far apart that a second has fewer.
TEST(TestedHypothesis, HasBlocksOfEightRowsAtLeast) {
  const LinearRelation relation;
  const std::vector<Record> records{
      linear_record("one", Use::Fit, 0.5, VectorXd::Constant(64, 3), {})};
  const Problem problem = linear_problem(relation, records);

  const auto blocks = TestedHypothesis{problem, relation.stated}.blocks(whole({0}));

  EXPECT_EQ(blocks, std::vector<double>(8, 36));
}

TEST(TestedHypothesis, HasNoBlocksOutsideItsFold) {
  LinearRelation relation;
  const std::vector<Record> records{
      linear_record("one", Use::Fit, kEighth, VectorXd::Constant(96, 3), {})};
  const Problem problem = linear_problem(relation, records);
  Fold fold = whole({0});
  fold.shares[0].weight = Eigen::ArrayXd::Zero(96);
  fold.shares[0].weight.segment(20, 40).setOnes();

  const TestedHypothesis tested{problem, relation.stated};

  // Rows 16 … 63, of which 20 … 59 count: ½ 3² each.
  EXPECT_EQ(tested.blocks(fold), (std::vector<double>{18, 36, 36, 36, 36, 18}));
  EXPECT_EQ(observations(problem, fold), 40);
  EXPECT_DOUBLE_EQ(tested.variance(fold), 9);
}

TEST(TestedHypothesis, DoesNotCompareRowsBeforeTheFirst) {
  LinearRelation relation;
  std::vector<Record> records{
      linear_record("one", Use::Fit, kEighth, VectorXd::Constant(96, 3), {})};
  records[0].settle = 2;
  const Problem problem = linear_problem(relation, records);

  EXPECT_EQ(observations(problem, whole({0})), 80);
  EXPECT_DOUBLE_EQ((TestedHypothesis{problem, relation.stated}.variance(whole({0}))), 9);
}

TEST(TestedHypothesis, DoesNotCompareRowsInGaps) {
  LinearRelation relation;
  VectorXd y = VectorXd::Constant(96, 3);
  y.segment(40, 16).setConstant(100);
  std::vector<Record> records{linear_record("one", Use::Fit, kEighth, y, {})};
  records[0].gaps = {{40, 56}};
  const Problem problem = linear_problem(relation, records);
  const TestedHypothesis tested{problem, relation.stated};
  const Fold all = compared(problem, {0});

  EXPECT_EQ(observations(problem, all), 80);
  EXPECT_DOUBLE_EQ(tested.variance(all), 9);
  EXPECT_EQ(tested.whitened(0).col(0).segment(40, 16).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(problem.drive(0).compared_rows(y), MatrixXd::Constant(80, 1, 3));
}

TEST(TestedHypothesis, HasNoOffsetIfThatIsFree) {
  LinearRelation relation;
  relation.offsets = true;
  const VectorXd x = sine_of(3, 96);
  const std::vector<Record> records{
      linear_record("one", Use::Fit, kEighth, (x.array() + 50).matrix(), {})};
  const Problem problem = linear_problem(relation, records);

  EXPECT_LT((TestedHypothesis{problem, relation.stated}.whitened(0) - x).cwiseAbs().maxCoeff(),
            1e-10);
}

// The noise has the deviation 1 about its offset of 3 or -3. The rows before the first are no part
// of the mean.
TEST(Problem, HasNoiseWithoutAnOffsetIfThatIsFree) {
  LinearRelation relation;
  relation.offset_noise = 3;
  std::vector<Record> records{linear_record("one", Use::Fit, kEighth, sine_of(3, 96), {})};
  records[0].settle = 2 * kEighth;
  const auto deviation = [&] { return linear_problem(relation, records).noise(0).deviation(); };

  EXPECT_NEAR(deviation()(50, 0), std::sqrt(10), 1e-12);
  relation.offsets = true;
  EXPECT_NEAR(deviation()(50, 0), 1, 1e-12);
}

TEST(TestedHypothesis, SaysThatThereIsNoPrediction) {
  LinearRelation relation;
  const std::vector<Record> records{linear_record("one", Use::Fit, kEighth, sine_of(3, 96), {})};
  const Problem problem = linear_problem(relation, records);
  relation.has_prediction = false;
  const TestedHypothesis tested{problem, relation.stated};

  EXPECT_EQ(tested.prediction(0).size(), 0);
  EXPECT_TRUE(tested.blocks(whole({0})).empty());
  EXPECT_EQ(test::error_of([&] { static_cast<void>(tested.whitened(0)); }),
            "one: the model has no prediction");
  EXPECT_EQ(test::error_of([&] { static_cast<void>(linear_problem(relation, records)); }),
            "one: the model has no prediction (linear): it diverges");
}

// Normal equations: Σ x y/Σ x², here of two orthogonal signals.
TEST(TestedHypothesis, FitsLinearParametersExactly) {
  LinearRelation relation;
  const VectorXd x = sine_of(3, 200), y = sine_of(5, 200);
  const VectorXd measured = 2 * x - 7 * y + sine_of(9, 200);
  const std::vector<Record> records{
      linear_record("one", Use::Fit, kEighth, measured, {{"x", x}, {"y", y}})};
  const Problem problem = linear_problem(relation, records);

  const Fit fit = TestedHypothesis{problem, linear_model({"x", "y"}, {0, 0})}.fit(whole({0}), 12);

  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.parameters[0], 2, 1e-5);
  EXPECT_NEAR(fit.parameters[1], -7, 1e-5);
  EXPECT_NEAR(fit.sum_of_squares, 200, 1e-3);
}

// Hoerl & Kennard 1970, about the start: b (x·x/s²)/(x·x/s² + r²) away from it, with x·x = 100.
TEST(TestedHypothesis, ARidgeHoldsAParameterNearItsStart) {
  LinearRelation relation;
  relation.deviation = {2};
  const MatrixXd x = sine_of(3, 100);
  const std::vector<Record> records{linear_record("one", Use::Fit, kEighth, 3 * x, {{"x", x}})};
  const Problem problem = linear_problem(relation, records);
  const TestedHypothesis tested{problem, linear_model({"x"}, {1})};

  const Fit fit = tested.fit(whole({0}), 20, VectorXd::Constant(1, 5));

  constexpr double kDamping = 1e-4;  // of the first step, which ends within the fit's tolerance
  EXPECT_NEAR(fit.parameters[0], 1 + 2 * 25 / (25 + 25.0), 1.1 * kDamping);
}

TEST(Problem, OfFutureTestsHasTheNoiseOfTheFirstRecord) {
  LinearRelation relation;
  relation.deviation = {4};
  const std::vector<Record> records{linear_record("one", Use::Fit, kEighth, sine_of(3, 200), {})};
  const Record test = linear_record("next", Use::Fit, kEighth, sine_of(3, 80), {});
  const Problem problem = linear_problem(relation, records);

  const Problem next{problem, {&test}};

  EXPECT_LT((next.noise(0).deviation().array() - 4).abs().maxCoeff(), 1e-12);
  EXPECT_EQ(next.noise(0).deviation().rows(), 80);
  EXPECT_NEAR(problem.log_noise(relation.stated).value(), std::log(4), 1e-12);
}

TEST(Problem, KeepsTheNoiseOfARecordThatAModelDoesNotPredict) {
  LinearRelation relation;
  relation.deviation = {4};
  const std::vector<Record> records{linear_record("one", Use::Fit, kEighth, sine_of(3, 200), {})};
  Problem problem = linear_problem(relation, records);
  relation.deviation = {2};
  relation.has_prediction = false;

  problem.renew_noise(relation.stated);

  EXPECT_LT((problem.noise(0).deviation().array() - 4).abs().maxCoeff(), 1e-12);
  EXPECT_FALSE(problem.log_noise(relation.stated));
  EXPECT_THROW(static_cast<void>(problem.draws_at(relation.stated, 0)), Error);
}

}  // namespace
}  // namespace rths::diagnosis
