// SPDX-License-Identifier: Apache-2.0
#include "model_comparison.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Scores = ModelComparison::Scores;

constexpr Eigen::Index kComparedRows = 600;  // of each of two records
constexpr double kComparedStep = 0.05;
constexpr std::uint64_t kComparisonSeed = 1;

/// The outputs of two records are multiples of one sine, plus a residual. The noise of the sensors
/// has variance 1.
struct TwoSlopes {
  LinearRelation relation;
  std::vector<Record> records;
  Folds folds = two_records();

  TwoSlopes(double first, double second, const Eigen::VectorXd& residual) {
    relation.stated = linear_model({"x"}, {0});
    const Eigen::VectorXd sine = sine_of(3, kComparedRows);
    for (const double slope : {first, second})
      records.push_back(
          linear_record("record", Use::Fit, kComparedStep, slope * sine + residual, {{"x", sine}}));
  }
  TwoSlopes(double first, double second)
      : TwoSlopes{first, second, Eigen::VectorXd::Zero(kComparedRows)} {}

  template <class Question>
  auto ask(const Question& question) const {
    const Problem problem = linear_problem(relation, records);
    return question(ModelComparison{problem, folds, kComparisonSeed});
  }
  [[nodiscard]] bool leaves_noise() const {
    return ask(
        [](const auto& comparison) { return comparison.is_noise(linear_model({"x"}, {2})); });
  }
};

TEST(ModelComparison, TakesTheVarianceOfTheSecondRecord) {
  const double variance = TwoSlopes{2, 5}.ask(
      [](const auto& comparison) { return comparison.variance(linear_model({"x"}, {2})); });

  EXPECT_NEAR(variance, 9, 1e-9);
}

// ½ n (5 - 2)² on the second record, less the ½ n of the noise; refitted there, the same on the
// first.
TEST(ModelComparison, ScoresOnTheRecordThatWasNotFitted) {
  const Scores both = TwoSlopes{2, 5}.ask(
      [](const auto& comparison) { return comparison.scores(linear_model({"x"}, {2})); });

  const double expected = 0.5 * kComparedRows * (9 - 1);
  EXPECT_NEAR(sum(both.second), expected, 1e-6 * expected);
  EXPECT_NEAR(sum(both.first), expected, 1e-6 * expected);
}

TEST(ModelComparison, AddsTheGainsOfBothRecords) {
  const auto gains = [](double in_second, double in_first, double least) {
    const Scores before{std::vector<double>(20, 10), std::vector<double>(20, 10)};
    const Scores after{std::vector<double>(20, 10 - in_second),
                       std::vector<double>(20, 10 - in_first)};
    return TwoSlopes{1, 1}.ask([&](const auto& comparison) {
      return comparison.gains(before, after, {least, kLeastGainOfAnEvent});
    });
  };

  EXPECT_TRUE(gains(1, 2, 59));
  EXPECT_FALSE(gains(1, 2, 61));
  EXPECT_FALSE(gains(2, -2, 0));
}

// A model of slope 2 where 5 is right leaves a sine of 3 times the noise, whose neighbours agree.
TEST(ModelComparison, ScattersByWhatAModelLeaves) {
  const auto scatter = [](double slope) {
    return TwoSlopes{2, slope}.ask(
        [](const auto& comparison) { return comparison.scatter(linear_model({"x"}, {2})); });
  };

  EXPECT_EQ(scatter(2), 1);
  EXPECT_GT(scatter(5), 9);
}

TEST(ModelComparison, TakesWhiteNoiseOfTheKnownSizeForNoise) {
  const Eigen::VectorXd white = gauss(kComparedRows, 1, 1);

  EXPECT_TRUE((TwoSlopes{2, 2, 0.9 * white}.leaves_noise()));
  EXPECT_FALSE((TwoSlopes{2, 2, 1.2 * white}.leaves_noise())) << "too large";
  EXPECT_FALSE((TwoSlopes{2, 2, 0.5 * sine_of(10, kComparedRows)}.leaves_noise())) << "coloured";
}

TEST(ModelComparison, CountsNoChangeBelowTheErrorsOfIntegration) {
  const auto is_material = [](double change) {
    return TwoSlopes{2, 2}.ask([&](const auto& comparison) {
      return comparison.is_material(linear_model({"x"}, {2}), linear_model({"x"}, {2 + change}));
    });
  };

  EXPECT_TRUE(is_material(2 * 1.01 * kMaterial));
  EXPECT_FALSE(is_material(2 * 0.99 * kMaterial));
}

TEST(ModelComparison, KnowsAModelWithoutPrediction) {
  TwoSlopes two{2, 2};
  const Problem problem = linear_problem(two.relation, two.records);
  const ModelComparison comparison{problem, two.folds, kComparisonSeed};
  EXPECT_TRUE(comparison.predicts(linear_model({"x"}, {2})));

  two.relation.has_prediction = false;

  EXPECT_FALSE(comparison.predicts(linear_model({"x"}, {2})));
}

}  // namespace
}  // namespace rths::diagnosis
