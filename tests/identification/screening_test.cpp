// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/screening.hpp>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kScreenRows = 400, kScreenNoise = 0.5;

/// y = 3 a + 2 b, of which the model knows a. All other signals are made of a, b and c, which are
/// orthogonal.
class Screening : public ::testing::Test {
 protected:
  static std::vector<Record> records_of_screening() {
    const VectorXd a = sine_of(3, 400), b = sine_of(5, 400), c = sine_of(7, 400);
    return {linear_record("one", Use::Fit, 0.05, 3 * a + 2 * b,
                          {{"a", a},
                           {"b.coefficient", b},
                           {"skew.coefficient", b + 4 * a},
                           {"half.coefficient", b + c},
                           {"other.coefficient", c},
                           {"same.coefficient", 0.5 * a}})};
  }
  static LinearRelation relation_of_screening() {
    LinearRelation relation;
    relation.deviation = {kScreenNoise};
    return relation;
  }
  [[nodiscard]] std::vector<Screened> screened(const std::vector<Candidate>& candidates) const {
    return screen(TestedHypothesis{problem, linear_model({"a"}, {3})}, whole({0}), candidates);
  }
  [[nodiscard]] double gain(const Candidate& candidate) const {
    const auto result = screened({candidate});
    return result.empty() ? -1 : result[0].gain;
  }

  const std::vector<Record> records = records_of_screening();
  const LinearRelation relation = relation_of_screening();
  const Problem problem = linear_problem(relation, records);
  // ½ (residual · signature)²/|signature|², in multiples of the noise: ½ 2² · 400/0.5².
  static constexpr double kWhole = 0.5 * 4 * kScreenRows / (kScreenNoise * kScreenNoise);
};

TEST_F(Screening, GainsHalfTheSquaredProjection) {
  EXPECT_NEAR(gain(friction("b")), kWhole, 1e-9 * kWhole);
  // (b, b + c)²/|b + c|² is half of |b|².
  EXPECT_NEAR(gain(friction("half")), kWhole / 2, 1e-9 * kWhole);
  EXPECT_NEAR(gain(friction("other")), 0, 1e-9 * kWhole);
}

TEST_F(Screening, IgnoresWhatFittedParametersReproduce) {
  EXPECT_NEAR(gain(friction("skew")), kWhole, 1e-9 * kWhole);
  EXPECT_EQ(gain(friction("same")), 0);
}

TEST_F(Screening, CombinesTheParametersOfACandidate) {
  Candidate both = friction("half");
  both.frees.push_back(size_parameter("other.coefficient"));
  both.starts = {VectorXd::Zero(2)};

  EXPECT_NEAR(gain(both), kWhole, 1e-9 * kWhole);
}

// A parameter in N/m³ of a motion of a millimetre has such a small signature per unit.
TEST_F(Screening, DoesNotDependOnTheUnitOfAParameter) {
  constexpr auto kRows = static_cast<Eigen::Index>(kScreenRows);
  const VectorXd a = sine_of(3, kRows), b = sine_of(5, kRows);
  const std::vector<Record> one{linear_record("one", Use::Fit, 0.05, 3 * a + 2 * b,
                                              {{"a", a}, {"b.coefficient", 1e-15 * b}})};
  const Problem its = linear_problem(relation, one);

  const auto result =
      screen(TestedHypothesis{its, linear_model({"a"}, {3})}, whole({0}), {friction("b")});

  EXPECT_NEAR(result[0].gain, kWhole, 1e-9 * kWhole);
}

// A size of at least zero.
TEST_F(Screening, GainsNothingWithTheWrongSign) {
  const auto gain_if = [&](double size) {
    const VectorXd b = sine_of(5, 400);
    const std::vector<Record> one{
        linear_record("one", Use::Fit, 0.05, size * b, {{"b.coefficient", b}})};
    const Problem its = linear_problem(relation, one);
    return screen(TestedHypothesis{its, relation.stated}, whole({0}), {friction("b", 0)})[0].gain;
  };

  EXPECT_NEAR(gain_if(2), kWhole, 1e-9 * kWhole);
  EXPECT_EQ(gain_if(-2), 0);
}

// An effect with a threshold: its signature is its whole difference from the model without it.
TEST_F(Screening, TriesTheWholeEffectIfItsSizeCannotBeZero) {
  Candidate threshold = friction("b", 0.1);
  threshold.starts = {VectorXd::Constant(1, 1.5)};

  EXPECT_NEAR(gain(threshold), kWhole, 1e-9 * kWhole);
}

TEST_F(Screening, IsSortedAndCountsHiddenCandidatesAsTheBest) {
  Candidate hidden = friction("same");
  hidden.is_hidden = true;
  const std::vector<Candidate> candidates{friction("other"), friction("half"), hidden,
                                          friction("b")};

  const auto result = screened(candidates);

  ASSERT_EQ(result.size(), 4U);
  EXPECT_EQ(result[0].candidate->name, "same");
  EXPECT_EQ(result[1].candidate->name, "b");
  EXPECT_EQ(result[2].candidate->name, "half");
  EXPECT_EQ(result[3].candidate->name, "other");
  EXPECT_EQ(result[0].gain, result[1].gain);
}

TEST_F(Screening, IsOfTheRowsOfItsFold) {
  Fold quarter = whole({0});
  quarter.shares[0].weight = Eigen::ArrayXd::Zero(400);
  // 100 rows hold no whole cycles, so that only all rows of a quarter of the signals remain.
  quarter.shares[0].weight.head(100).setOnes();
  VectorXd b = sine_of(5, 400).head(100);
  const VectorXd a = sine_of(3, 400).head(100);
  b -= a * (a.dot(b) / a.squaredNorm());

  const auto result =
      screen(TestedHypothesis{problem, linear_model({"a"}, {3})}, quarter, {friction("b")});

  const double expected = 0.5 * 4 * b.squaredNorm() / (kScreenNoise * kScreenNoise);
  EXPECT_NEAR(result[0].gain, expected, 1e-9 * expected);
}

TEST(Complement, RemovesTheSpanOfItsColumns) {
  MatrixXd columns(50, 3);
  columns << sine_of(2, 50), 1e-7 * sine_of(3, 50), sine_of(2, 50);  // one of them twice
  VectorXd x = 3 * sine_of(2, 50) - 8 * sine_of(3, 50) + sine_of(4, 50);

  Complement{columns}.take_out(x);

  EXPECT_LT((x - sine_of(4, 50)).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace rths::diagnosis
