// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/proof.hpp>

#include <cmath>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kProofStep = 0.05;

Whiteness whiteness_of_signal(const MatrixXd& residual) {
  const LinearRelation relation{std::vector<std::string>(std::size_t(residual.cols()), "N")};
  const std::vector<Record> records{linear_record("one", Use::Fit, kProofStep, residual, {})};
  const Problem problem = linear_problem(relation, records);
  return whiteness_of(TestedHypothesis{problem, relation.stated}, 0);
}

// x(t) = ρ x(t-1) + e(t), from its stationary distribution on.
VectorXd first_order(double rho, Index rows, unsigned seed) {
  VectorXd x = gauss(rows, 1, seed);
  x[0] /= std::sqrt(1 - rho * rho);
  for (Index i = 1; i < rows; ++i) x[i] += rho * x[i - 1];
  return x;
}

// Of 20 lags, each beyond the bound with probability 5 %, six or more are so in 0.03 % of cases.
// The statistic has 20 degrees of freedom, so that it passes in all but 10⁻¹⁴ of cases.
TEST(Whiteness, IsOfWhiteNoise) {
  int passed = 0;
  for (unsigned seed = 1; seed <= 20; ++seed)
    passed += whiteness_of_signal(gauss(1000, 1, seed)).is_white ? 1 : 0;
  EXPECT_EQ(passed, 20);

  const Whiteness white = whiteness_of_signal(gauss(4000, 1, 1));

  EXPECT_DOUBLE_EQ(white.bound, 1.96 / std::sqrt(4000.0));
  ASSERT_EQ(white.correlation.size(), 20U);
  EXPECT_LT(std::count_if(white.correlation.begin(), white.correlation.end(),
                          [&](double r) { return std::abs(r) > white.bound; }),
            6);
}

// Bartlett (1946): the variance of the correlation at lag k of n samples is
// [(1 + ρ²)(1 - ρ^2k)/(1 - ρ²) - 2 k ρ^2k]/n. Four deviations for each of 20 lags.
TEST(Whiteness, IsNotOfAutoregressiveNoise) {
  constexpr double kRho = 0.6, kSamples = 20'000;

  const Whiteness coloured = whiteness_of_signal(first_order(kRho, Index(kSamples), 1));

  EXPECT_FALSE(coloured.is_white);
  for (int lag = 1; lag <= 20; ++lag) {
    const double square = std::pow(kRho, 2 * lag);
    const double variance = (1 + kRho * kRho) * (1 - square) / (1 - kRho * kRho) - 2 * lag * square;
    EXPECT_NEAR(coloured.correlation[std::size_t(lag - 1)], std::pow(kRho, lag),
                4 * std::sqrt(variance / kSamples))
        << lag;
  }
}

TEST(Whiteness, IsLostIfOneOutputIsColoured) {
  MatrixXd residual = gauss(4000, 2, 1);
  EXPECT_TRUE(whiteness_of_signal(residual).is_white);
  EXPECT_DOUBLE_EQ(whiteness_of_signal(residual).bound, 1.96 / std::sqrt(8000.0));

  residual.col(1) = first_order(0.4, 4000, 2);

  EXPECT_FALSE(whiteness_of_signal(residual).is_white);
}

Proof proof_with(double before, double after, double floor, bool is_white) {
  Proof proof;
  proof.before = before;
  proof.after = after;
  proof.floor = floor;
  proof.is_white = is_white;
  proof.records.emplace_back().variance_after = std::pow(after / floor, 2);
  return proof;
}

TEST(Proof, CountsTheExplainedEnergyBeyondTheNoise) {
  EXPECT_DOUBLE_EQ(proof_with(5, 3, 2, false).explained(), (25.0 - 9) / (25 - 4));
  EXPECT_EQ(proof_with(5, 1, 2, false).explained(), 1);  // below the noise
  EXPECT_EQ(proof_with(5, 6, 2, false).explained(), 0);  // worse
  EXPECT_EQ(proof_with(2, 1, 2, false).explained(), 0);  // nothing to explain
}

TEST(Proof, IsSystematicIfColouredAndWellAboveTheNoise) {
  EXPECT_DOUBLE_EQ(proof_with(5, 3, 2, false).times_noise(), 1.5);
  EXPECT_TRUE(proof_with(5, 3, 2, false).is_systematic());
  EXPECT_FALSE(proof_with(5, 3, 2, true).is_systematic());
  EXPECT_FALSE(proof_with(5, 2.4, 2, false).is_systematic());
}

// Slow noise, whose size a short rest does not show, raises the error but hardly the variance of
// the whitened residual.
TEST(Proof, IsNotSystematicIfTheWhitenedResidualIsHardlyLargerThanNoise) {
  Proof proof = proof_with(5, 3, 2, false);
  proof.records[0].variance_after = 1.2;

  EXPECT_FALSE(proof.is_systematic());
}

/// Two outputs y = 3 x + 4 z on the first record, and y = 3 x on the second. The model before has
/// no parameter of any effect; that after knows x.
class ProofOfTwoRecords : public ::testing::Test {
 protected:
  ProofOfTwoRecords() {
    selection.base = linear_model({"x"}, {0});
    selection.named = linear_model({"x"}, {3});
  }

  // Unit of the second output: all its signals are this many times as large.
  static std::vector<Record> records_in(double unit) {
    MatrixXd x(400, 2), z(400, 2);
    x << sine_of(3, 400), unit * sine_of(4, 400);
    z << sine_of(7, 400), unit * sine_of(9, 400);
    MatrixXd first = 3 * x + 4 * z;
    first.col(0).array() += 7;  // an offset is no error
    return {linear_record("first", Use::Fit, kProofStep, first, {{"x", x}}),
            linear_record("second", Use::HeldOut, kProofStep, 3 * x, {{"x", x}})};
  }
  static LinearRelation relation_in(const std::string& unit, double size) {
    LinearRelation relation{{"N", unit}};
    relation.deviation = {0.5, 0.5 * size};
    return relation;
  }

  Selection selection;
};

TEST_F(ProofOfTwoRecords, HasErrorsOverTheMeasurement) {
  const auto records = records_in(1);
  const LinearRelation relation = relation_in("N", 1);
  const Problem problem = linear_problem(relation, records);

  const auto scores = scores_of(problem, selection, false);

  // Mean squares: 25 measured, 16 not explained, 0.25 of noise.
  ASSERT_EQ(scores.size(), 2U);
  EXPECT_NEAR(scores[0].nrmse_before, 1, 1e-12);
  EXPECT_NEAR(scores[0].nrmse_stated, 1, 1e-12);
  EXPECT_NEAR(scores[0].nrmse_after, 4.0 / 5, 1e-12);
  EXPECT_NEAR(scores[0].noise_floor, 0.5 / 5, 1e-12);
  EXPECT_NEAR(scores[1].nrmse_after, 0, 1e-12);
  EXPECT_NEAR(scores[1].noise_floor, 0.5 / 3, 1e-12);
  EXPECT_NEAR(scores[1].variance_before, 9 / 0.25, 1e-9);
  EXPECT_EQ(scores[0].record, "first");
  EXPECT_EQ(scores[0].use, "fit");
  EXPECT_EQ(scores[1].use, "scored");
  EXPECT_EQ(scores_of(problem, selection, true)[0].use, "held_out");
}

TEST_F(ProofOfTwoRecords, WeighsRecordsByTheirEnergy) {
  const auto records = records_in(1);
  const LinearRelation relation = relation_in("N", 1);
  const Problem problem = linear_problem(relation, records);

  const Proof proof = proof_of(problem, selection, true);

  EXPECT_TRUE(proof.is_held_out);
  EXPECT_NEAR(proof.before, 1, 1e-12);
  EXPECT_NEAR(proof.after, std::sqrt(16.0 / (25 + 9)), 1e-12);
  EXPECT_NEAR(proof.floor, std::sqrt(2 * 0.25 / (25 + 9)), 1e-12);
  EXPECT_FALSE(proof.is_white);  // the first record's sine, though not the last record's zeros
  EXPECT_TRUE(proof.whiteness.is_white);
}

TEST_F(ProofOfTwoRecords, WeighsRecordsOfSeveralUnitsAlike) {
  const auto records = records_in(1e-6);
  const LinearRelation relation = relation_in("m", 1e-6);
  const Problem problem = linear_problem(relation, records);

  const Proof proof = proof_of(problem, selection, true);

  EXPECT_NEAR(proof.after, std::sqrt((16.0 / 25 + 0) / 2), 1e-12);
  EXPECT_NEAR(proof.floor, std::sqrt((0.25 / 25 + 0.25 / 9) / 2), 1e-12);
}

TEST_F(ProofOfTwoRecords, DoesNotDependOnTheUnitOfAnOutput) {
  const Hypothesis model = linear_model({"x"}, {2});
  const auto error_in = [&](const std::string& unit, double size) {
    const auto records = records_in(size);
    const LinearRelation relation = relation_in(unit, size);
    const Problem problem = linear_problem(relation, records);
    return nrmse({problem, model}, 0, zeros_of({problem, model}));
  };

  EXPECT_NEAR(error_in("m", 1e-6), error_in("m", 1), 1e-12);
  // The same unit: the larger output counts more. Here both have the same relative error.
  EXPECT_NEAR(error_in("N", 1e-6), std::sqrt(1.0 + 16) / 5, 1e-12);
}

// y = 3 x + 2, and a zero of 5 that neither model has.
TEST_F(ProofOfTwoRecords, CountsAnOffsetThatIsAnEffect) {
  const VectorXd x = sine_of(3, 400), one = VectorXd::Ones(400);
  LinearRelation relation;
  const std::vector<Record> records{linear_record("one", Use::HeldOut, kProofStep,
                                                  3 * x + (2 + 5) * one, {{"x", x}, {"c", one}})};
  const Problem problem = linear_problem(relation, records);
  selection.named = linear_model({"x", "c"}, {3, 2});
  selection.base = linear_model({"x"}, {3});
  const auto score_if_free = [&](bool is_free) {
    relation.offsets = is_free;
    return scores_of(problem, selection, true)[0];
  };

  EXPECT_NEAR(score_if_free(false).nrmse_before, 2.0 / 3, 1e-12);
  EXPECT_NEAR(score_if_free(false).nrmse_after, 0, 1e-12);
  EXPECT_NEAR(score_if_free(true).nrmse_before, 0, 1e-12);
}

/// y = x, but for a wrong value in each row of a gap.
class ProofOfARecordWithAGap : public ::testing::Test {
 protected:
  static constexpr Index kRows = 400;
  static std::vector<Record> record_with_gap() {
    VectorXd y = sine_of(4, kRows);
    y.segment(100, 100).setConstant(50);
    std::vector<Record> records{
        linear_record("one", Use::Fit, kProofStep, y, {{"x", sine_of(4, kRows)}})};
    records[0].gaps = {{100, 200}};
    return records;
  }
  const std::vector<Record> records = record_with_gap();
  const LinearRelation relation;
  const Problem problem = linear_problem(relation, records);
};

TEST_F(ProofOfARecordWithAGap, DoesNotCompareIt) {
  Selection selection;
  selection.base = linear_model({"x"}, {0});
  selection.named = linear_model({"x"}, {1});

  const Proof proof = proof_of(problem, selection, true);

  // The gap is a whole period, so that the other rows have the mean square 1.
  EXPECT_NEAR(proof.before, 1, 1e-12);
  EXPECT_NEAR(proof.after, 0, 1e-12);
  EXPECT_NEAR(proof.records[0].variance_before, 1, 1e-9);
  EXPECT_NEAR(proof.variance(), 0, 1e-9);
}

TEST(Whiteness, IsOfTheComparedRows) {
  const LinearRelation relation;
  std::vector<Record> records{
      linear_record("one", Use::Fit, kProofStep, first_order(0.5, 4000, 1), {})};
  records[0].settle = 3600 * kProofStep;
  const Problem problem = linear_problem(relation, records);

  const Whiteness last = whiteness_of(TestedHypothesis{problem, relation.stated}, 0);

  EXPECT_NEAR(last.bound, 1.96 / std::sqrt(400.0), 1e-12);
  // Bartlett (1946), four deviations of (1 - ρ²)/n.
  EXPECT_NEAR(last.correlation[0], 0.5, 4 * std::sqrt(0.75 / 400));
}

TEST_F(ProofOfTwoRecords, HasNoErrorWithoutAPrediction) {
  const auto records = records_in(1);
  LinearRelation relation = relation_in("N", 1);
  const Problem problem = linear_problem(relation, records);
  relation.has_prediction = false;

  EXPECT_TRUE(std::isnan(nrmse({problem, selection.named}, 0, Zeros(2))));
}

}  // namespace
}  // namespace rths::diagnosis
