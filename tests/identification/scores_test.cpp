// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/scores.hpp>

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include <rths/identification/constants.hpp>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

constexpr Eigen::Index kChangeRows = 400;

double mean_of(const std::vector<double>& values) {
  return sum(values) / static_cast<double>(values.size());
}

double square_deviation(const std::vector<double>& values) {
  double square = 0;
  for (const double value : values) square += std::pow(value - mean_of(values), 2);
  return square / static_cast<double>(values.size());
}

std::vector<double> white_blocks(Eigen::Index count, double deviation, unsigned seed) {
  const Eigen::VectorXd x = deviation * gauss(count, 1, seed);
  return {x.begin(), x.end()};
}

/// y = 3 x without any noise, while the measured x has an error of ± d, row by row. The noise of
/// the residual is then 3 d.
class NoisyInput : public LinearRelation {
 public:
  static constexpr double kError = 0.2, kSlope = 3;
  static constexpr Eigen::Index kRows = 800;

  NoisyInput() { stated = linear_model({"x"}, {kSlope}); }
  [[nodiscard]] Record record(double sign) const {
    const Eigen::VectorXd truth = sine_of(3, kRows);
    Eigen::VectorXd measured = truth;
    for (Eigen::Index i = 0; i < kRows; ++i) measured[i] += (i % 2 == 0 ? 1 : -1) * kError;
    for (Eigen::Index i = 0; i < kRows; ++i) measured[i] += sign * (i % 2 == 0 ? 1 : -1) * kError;
    return linear_record("one", Use::Fit, 0.05, kSlope * truth, {{"x", measured}});
  }
  [[nodiscard]] std::vector<std::unique_ptr<Drive>> disturbed(
      const Drive& /*drive*/, const Record& /*noise*/) const override {
    std::vector<std::unique_ptr<Drive>> all;
    for (const double sign : {1.0, -1.0}) all.push_back(prepare(record(sign)));
    return all;
  }
};

// ½ Σ w² of slope v is n [(3 - v)² + v² d²]/(2 · 9 d²): least at 3/(1 + d²), not at 3. Without what
// the noise is expected to cause, n v²/(2 · 9), it is least at 3.
TEST(Scores, DoNotPreferASlopeThatReactsLessToTheNoiseOfItsInput) {
  const NoisyInput relation;
  const std::vector<Record> records{relation.record(0)};
  const Problem problem = linear_problem(relation, records);
  constexpr double d = NoisyInput::kError, n = NoisyInput::kRows, b = NoisyInput::kSlope;
  const auto blocks = [&](double slope) {
    return sum(TestedHypothesis{problem, linear_model({"x"}, {slope})}.blocks(whole({0})));
  };
  const auto score = [&](double slope) {
    return sum(scores(problem, linear_model({"x"}, {slope}), whole({0})));
  };
  const double attenuated = b / (1 + d * d);

  EXPECT_LT(blocks(attenuated), blocks(b));
  for (const double slope : {attenuated, b, 1.1 * b})
    EXPECT_NEAR(score(slope), n * std::pow((b - slope) / (b * d), 2) / 2, 1e-6 * n) << slope;
}

// The first output changes by a tenth of its size, the second not at all.
TEST(ChangeOf, CountsOutputsOfDifferentUnitsAlike) {
  const auto change_in = [](const std::string& unit, double size) {
    Eigen::MatrixXd measured(kChangeRows, 2), first(kChangeRows, 2);
    measured << sine_of(3, kChangeRows), size * sine_of(5, kChangeRows);
    first << 0.1 * sine_of(3, kChangeRows), Eigen::VectorXd::Zero(kChangeRows);
    const LinearRelation relation{{"N", unit}};
    const std::vector<Record> records{
        linear_record("one", Use::Fit, 0.05, measured, {{"x", first}})};
    const Problem problem = linear_problem(relation, records);
    return change_of(problem, linear_model({"x"}, {0}), linear_model({"x"}, {1}), whole({0}));
  };

  EXPECT_NEAR(change_in("N", 1), 0.1 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(change_in("N", 7), 0.1 / std::sqrt(1 + 49), 1e-12);
  for (const double size : {1e-3, 1.0, 1e3})
    EXPECT_NEAR(change_in("m", size), 0.1 / std::sqrt(2), 1e-12);
}

TEST(Minus, IsAsLongAsTheShorter) {
  EXPECT_EQ(minus({5, 7, 9}, {1, 2}), (std::vector<double>{4, 5}));
  EXPECT_EQ(minus({}, {1, 2}), std::vector<double>{});
  EXPECT_EQ(sum(minus({5, 7, 9}, {1, 2, 3})), 15);
}

TEST(ResampledSums, OfEqualBlocksAreTheirSum) {
  // 10 is no multiple of the 3 neighbours that are drawn together.
  for (const double total : resampled_sums(std::vector<double>(10, 2.5), 1))
    EXPECT_DOUBLE_EQ(total, 25);
}

// A resample of 300 blocks is 100 triples of neighbours, each one of the 298 equally likely. So its
// mean is 100 times the mean triple, and its variance 100 times their variance. Of 400 resamples,
// the mean has a standard error of √(variance/400), the variance a relative one of √(2/400).
TEST(ResampledSums, HaveMeanAndVarianceOfDrawnTriples) {
  const auto blocks = white_blocks(300, 2, 1);
  std::vector<double> triples;
  for (std::size_t i = 0; i + 3 <= blocks.size(); ++i)
    triples.push_back(blocks[i] + blocks[i + 1] + blocks[i + 2]);
  const double variance = 100 * square_deviation(triples);

  const auto sums = resampled_sums(blocks, 7);

  ASSERT_EQ(sums.size(), std::size_t{kResamples});
  EXPECT_NEAR(mean_of(sums), 100 * mean_of(triples), 3 * std::sqrt(variance / kResamples));
  EXPECT_NEAR(square_deviation(sums) / variance, 1, 3 * std::sqrt(2.0 / kResamples));
}

// The sum of n white blocks has the variance n σ². Overlapping triples correlate by 2/3 and 1/3, so
// that the variance of n of them has a relative error of √(2 (1 + 2 (4 + 1)/9)/n); that of the
// resamples comes on top.
TEST(ResampledSums, OfWhiteBlocksHaveTheVarianceOfTheirSum) {
  constexpr int kBlocks = 3000;
  const double error = std::sqrt(2.0 * (1 + 10.0 / 9) / kBlocks + 2.0 / kResamples);

  const auto sums = resampled_sums(white_blocks(kBlocks, 2, 3), 5);

  EXPECT_NEAR(square_deviation(sums) / (kBlocks * 4.0), 1, 3 * error);
}

// Resampling single blocks would give the variance of white blocks, 3000. A drawn triple of blocks
// that are alike in threes is 3 a, 2 a + b or a + 2 b, of mean square (9 + 5 + 5)/3.
TEST(ResampledSums, KeepTheCorrelationOfNeighbours) {
  const auto steps = white_blocks(1000, 1, 4);
  std::vector<double> blocks;
  for (const double step : steps) blocks.insert(blocks.end(), 3, step);

  const double variance = square_deviation(resampled_sums(blocks, 5));

  EXPECT_NEAR(variance / (1000 * 19.0 / 3), 1, 3 * std::sqrt(2.0 / 1000 + 2.0 / kResamples));
}

TEST(ResampledSums, DependOnTheSeedOnly) {
  const auto blocks = white_blocks(50, 1, 1);

  EXPECT_EQ(resampled_sums(blocks, 3), resampled_sums(blocks, 3));
  EXPECT_NE(resampled_sums(blocks, 3), resampled_sums(blocks, 4));
}

TEST(ResampledSums, NeedThreeBlocks) {
  EXPECT_TRUE(resampled_sums({1, 2}, 1).empty());
  EXPECT_EQ(resampled_sums({1, 2, 4}, 1), std::vector<double>(kResamples, 7));
}

TEST(Fitted, KeepsItsValuesIfThereIsNoPrediction) {
  LinearRelation relation;
  relation.stated = linear_model({"x"}, {0.5});
  const std::vector<Record> records{
      linear_record("one", Use::Fit, 0.1, 2 * sine_of(3, 60), {{"x", sine_of(3, 60)}})};
  const Problem problem = linear_problem(relation, records);
  EXPECT_NEAR(fitted(problem, relation.stated, whole({0}), kLongFit).values[0], 2, 1e-6);

  relation.has_prediction = false;

  EXPECT_EQ(fitted(problem, relation.stated, whole({0}), kLongFit).values[0], 0.5);
  EXPECT_TRUE(scores(problem, relation.stated, whole({0})).empty());
}

}  // namespace
}  // namespace rths::diagnosis
