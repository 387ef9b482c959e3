// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/relation_findings.hpp>

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kExaminedRows = 900;
constexpr double kExaminedStep = 0.05;

/// Three records, the last one held out, of two effects: `named`, which is a candidate, and
/// `unknown`, which is none. Noise of variance 1, unless grown.
struct Examined {
  double named = 0, unknown = 0;
  double noise = 1;                  ///< its deviation
  double unknown_scored = NAN;       ///< of the second record; NAN: as on the first
  double unknown_held_out = NAN;     ///< of the held-out record; NAN: as on the first
  std::vector<Record> records = {};  // NOLINT(readability-redundant-member-init): cases omit it
  std::unique_ptr<SensorNoise> sensors = nullptr;

  [[nodiscard]] std::unique_ptr<RelationFindings> found() {
    for (const int i : {0, 1, 2}) {
      const VectorXd signal = sine_of(3 + i, kExaminedRows);
      const double other = i == 0 ? NAN : i == 1 ? unknown_scored : unknown_held_out;
      const double rest = std::isnan(other) ? unknown : other;
      const VectorXd measured = named * signal + rest * sine_of(11 + i, kExaminedRows) +
                                noise * gauss(kExaminedRows, 1, 40 + unsigned(i));
      records.push_back(linear_record("record " + std::to_string(i),
                                      i == 0 ? Use::Fit : Use::HeldOut, kExaminedStep, measured,
                                      {{"x.coefficient", signal}}));
    }
    auto relation = std::make_unique<LinearRelation>();
    relation->known = {friction("x")};
    std::vector<const Record*> all;
    for (const auto& record : records) all.push_back(&record);
    sensors = std::make_unique<SensorNoise>(
        all, std::vector<std::pair<std::string, double>>{{"output.0", 1}});
    DiagnosisProgress progress;
    return examine(std::move(relation), records, *sensors, 1, progress);
  }
};

TEST(RelationFindings, OfNoiseFindsNothing) {
  Examined noise;
  const auto found = noise.found();

  EXPECT_FALSE(found->is_named());
  EXPECT_FALSE(found->has_remainder());
  EXPECT_FALSE(found->is_unknown());
  EXPECT_TRUE(found->descriptions.empty());
}

// The first record is fitted, the second scores, the third proves.
TEST(RelationFindings, NamesAnEffectAndProvesItOnTheRecordThatWasKeptBack) {
  Examined effect{.named = 2};
  const auto found = effect.found();

  ASSERT_TRUE(found->is_named());
  EXPECT_EQ(found->selection.rounds[0].chosen.candidate.name, "x");
  EXPECT_FALSE(found->has_remainder());
  EXPECT_FALSE(found->is_unknown());
  EXPECT_TRUE(found->proof.is_held_out);
  ASSERT_EQ(found->proof.records.size(), 1U);
  EXPECT_EQ(found->proof.records[0].record, "record 2");
  // NRMSE: effect and noise have the variances 4 and 1, of 5 in all.
  EXPECT_NEAR(found->proof.before, 1, 0.01);
  EXPECT_NEAR(found->proof.after, std::sqrt(1 / 5.0), 0.03);
  EXPECT_GT(found->proof.explained(), 0.97);
}

// Variances of the residual: 1 of noise and 4 of the rest.
TEST(RelationFindings, OfAnEffectThatIsNoCandidateIsUnknown) {
  Examined rest{.unknown = 2};
  const auto found = rest.found();

  EXPECT_FALSE(found->is_named());
  EXPECT_TRUE(found->has_remainder());
  EXPECT_TRUE(found->is_unknown());
  EXPECT_NEAR(found->proof.variance(), 5, 0.5);
  EXPECT_TRUE(found->proof.is_systematic());
}

// Beside an unknown rest, a candidate that explains 80 % of the residual is named, and one that
// explains 46 % only resembles part of the effect.
TEST(RelationFindings, NamesBesideAnUnknownEffectOnlyWhatExplainsMost) {
  Examined most{.named = 4, .unknown = 2}, little{.named = 3.7, .unknown = 4};
  const auto named = most.found(), unknown = little.found();

  EXPECT_TRUE(named->is_unknown());
  EXPECT_TRUE(named->is_named());
  EXPECT_NEAR(named->proof.explained(), 0.8, 0.05);
  EXPECT_TRUE(unknown->is_unknown());
  EXPECT_FALSE(unknown->is_named());
  EXPECT_EQ(unknown->proof.explained(), 0);
  ASSERT_EQ(unknown->withdrawn.size(), 1U);
  EXPECT_EQ(unknown->withdrawn[0].candidate.name, "x");
  EXPECT_EQ(unknown->withdrawn[0].reason, "most of the residual remains unknown");
}

// A residual of the variance 1 + 1.3² in one record is an event; 1 + 0.7² may be noise.
TEST(RelationFindings, OfAnEventOfOneRecordIsUnknown) {
  for (const double size : {0.7, 1.3}) {
    Examined event{.unknown = size, .unknown_scored = 0, .unknown_held_out = 0};
    const auto found = event.found();

    EXPECT_FALSE(found->is_named());
    EXPECT_NEAR(found->proof.variance(), 1, 0.15);
    EXPECT_EQ(found->is_unknown(), size > 1) << size;
  }
}

// Two outputs of one unit; the second one is ten times as exact. Their noise is white.
class TwoOutputs final : public LinearRelation {
 public:
  TwoOutputs() : LinearRelation{{"N", "N"}} { deviation = {0, 0}; }
  [[nodiscard]] std::vector<std::unique_ptr<Drive>> disturbed(const Drive& drive,
                                                              const Record& noise) const override {
    auto all = LinearRelation::disturbed(drive, noise);
    for (auto& one : all) one->measured += of_sensors(++seed_);
    return all;
  }
  static Eigen::MatrixXd of_sensors(unsigned seed) {
    return gauss(kExaminedRows, 2, seed) * VectorXd{{1, 0.1}}.asDiagonal();
  }

 private:
  mutable unsigned seed_ = 1000;
};

// The first output has a sine of variance 0.8 beside noise of 1: the whitened residual of both has
// the mean variance 1.4, the error is √1.8 times that of the noise.
bool is_unknown_beside(bool has_line_at_rest) {
  std::vector<Record> records, rests;
  for (const unsigned i : {0U, 1U, 2U}) {
    Eigen::MatrixXd measured = TwoOutputs::of_sensors(40 + i);
    measured.col(0) += std::sqrt(0.8) * sine_of(90, kExaminedRows);
    records.push_back(linear_record("record " + std::to_string(i), i == 0 ? Use::Fit : Use::HeldOut,
                                    kExaminedStep, measured, {}));
    Eigen::MatrixXd at_rest = TwoOutputs::of_sensors(60 + i);
    if (has_line_at_rest) at_rest.col(0) += std::sqrt(0.8) * sine_of(90, kExaminedRows);
    rests.push_back(linear_record("rest", Use::Reference, kExaminedStep, at_rest, {}));
    rests.back().quiet = {0, kExaminedRows};
  }
  std::vector<const Record*> all;
  for (const auto& record : records) all.push_back(&record);
  for (const auto& rest : rests) all.push_back(&rest);
  const SensorNoise sensors{all, {}};
  DiagnosisProgress progress;
  const auto found = examine(std::make_unique<TwoOutputs>(), records, sensors, 1, progress);
  EXPECT_EQ(sensors.lines().empty(), !has_line_at_rest);
  EXPECT_TRUE(found->proof.is_systematic());
  EXPECT_NEAR(found->proof.variance(), 1.4, 0.1);
  return found->is_unknown();
}

TEST(RelationFindings, OfALineAtRestIsUnknown) {
  EXPECT_TRUE(is_unknown_beside(true));
  EXPECT_FALSE(is_unknown_beside(false));
}

// 99 % is explained; the rest, of variance 1, is reported and does not take the name back.
TEST(RelationFindings, NamesAnEffectBesideASmallRemainder) {
  Examined both{.named = 10, .unknown = 1};
  const auto found = both.found();

  ASSERT_TRUE(found->is_named());
  EXPECT_TRUE(found->has_remainder());
  EXPECT_FALSE(found->is_unknown());
}

TEST(RelationFindings, IsUnknownIfTheNamedTermExplainsLittle) {
  Examined both{.named = 1, .unknown = 3};
  const auto found = both.found();

  EXPECT_TRUE(found->has_remainder());
  EXPECT_TRUE(found->is_unknown());
}

// White noise that is stronger than stated: variance 1.3. It is reported, and it is no effect.
TEST(RelationFindings, TakesALittleMoreNoiseForNoise) {
  Examined noisy{.noise = std::sqrt(1.3)};
  const auto found = noisy.found();

  EXPECT_TRUE(found->has_remainder());
  EXPECT_FALSE(found->is_unknown());
}

// Only the largest record counts: an event on the held-out record is not noise.
TEST(RelationFindings, IsUnknownIfOnlyTheHeldOutRecordAndTheNoiseDiffer) {
  Examined event{.unknown = 1, .unknown_held_out = 3};
  const auto found = event.found();

  EXPECT_TRUE(found->is_unknown());
  EXPECT_NEAR(found->proof.variance(), 10, 1);
}

}  // namespace
}  // namespace rths::diagnosis
