// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/pruning.hpp>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kPruneRows = 600;
constexpr double kPruneStep = 0.05;

/// A selection of candidates "x" and "y" with orthogonal signals. Their sizes on the records that
/// fit and on a held-out record are chosen by each test. White noise of variance 1 has no component
/// along the signals, so that the sizes are fitted exactly.
class Pruning : public ::testing::Test {
 protected:
  struct Sizes {
    double x, y, unknown;
    double noise = 1;
  };

  [[nodiscard]] static Record pruned_record(const std::string& name, Use use, const Sizes& sizes,
                                            unsigned seed) {
    const VectorXd x = sine_of(3, kPruneRows), y = sine_of(5, kPruneRows);
    VectorXd rest = gauss(kPruneRows, 1, seed);
    for (const VectorXd& signal : {x, y}) rest -= signal * (signal.dot(rest) / kPruneRows);
    return linear_record(
        name, use, kPruneStep,
        sizes.x * x + sizes.y * y + sizes.unknown * sine_of(9, kPruneRows) + sizes.noise * rest,
        {{"x.coefficient", x}, {"y.coefficient", y}, {"x.play", y}});
  }
  void add(const Candidate& candidate) {
    selection.named = extended(selection.named, candidate, candidate.starts[0]);
    selection.rounds.push_back({{candidate, selection.named, 0, {}, 0, 0, 0}, {}, {}});
  }
  std::vector<std::string> reasons(const Sizes& fitted, const std::vector<Sizes>& held) {
    for (const unsigned i : {0U, 1U})
      records.push_back(pruned_record("fit", Use::Fit, fitted, 1 + i));
    for (const auto& sizes : held)
      held_records.push_back(pruned_record("unseen", Use::HeldOut, sizes, 3));
    Problem problem = linear_problem(relation, records);
    finish(problem, two_records(), selection);
    std::vector<std::string> all;
    if (held.empty()) {
      for (const auto& one : prune(problem, nullptr, two_records(), noise, selection))
        all.push_back(one.candidate.name + ": " + one.reason);
      return all;
    }
    const Problem unseen = linear_problem(relation, held_records);
    for (const auto& one : prune(problem, &unseen, two_records(), noise, selection))
      all.push_back(one.candidate.name + ": " + one.reason);
    return all;
  }

  LinearRelation relation;
  Selection selection;
  std::vector<Record> records, held_records;
  const Record still = linear_record("still", Use::Reference, kPruneStep, sine_of(3, 100), {});
  // The displacement's noise is 0.5, in the scaled units of these tests.
  const SensorNoise noise{{&still}, {{"displacement.long", 0.5}}};
};

using Reasons = std::vector<std::string>;

// On 1200 rows, the interval is ± 1.96/√1200 = 0.057. It may be wider by the error of a variance
// that is taken from 40 blocks: for 0.08, that would need twice the variance, four deviations more.
TEST_F(Pruning, WithdrawsASizeThatMayBeZero) {
  add(friction("x"));
  add(friction("y"));

  EXPECT_EQ(reasons({0.08, 0.05, 0}, {}), Reasons{"y: its size may be zero"});
  ASSERT_EQ(selection.rounds.size(), 1U);
  EXPECT_EQ(selection.rounds[0].chosen.candidate.name, "x");
  ASSERT_EQ(selection.named.free.size(), 1U);
  EXPECT_EQ(selection.named.free[0].name, "x.coefficient");
}

TEST_F(Pruning, KeepsACandidateIfOneOfItsSizesIsNotZero) {
  Candidate both = friction("x");
  both.frees.push_back(size_parameter("y.coefficient"));
  both.starts = {VectorXd::Zero(2)};
  add(both);

  EXPECT_EQ(reasons({0.01, 0.5, 0}, {}), Reasons{});
}

TEST_F(Pruning, ComparesASizeWithTheValueOfNoEffect) {
  Candidate gain = friction("x");
  gain.frees[0].absent = 1;
  add(gain);

  EXPECT_EQ(reasons({1.01, 0, 0}, {}), Reasons{"x: its size may be zero"});
}

// y changes the term of x, so that x stays although its own size may be zero.
TEST_F(Pruning, KeepsATermThatAnotherCandidateChanges) {
  Candidate change = friction("y");
  change.adds.clear();
  change.frees = {size_parameter("x.play")};
  add(friction("x"));
  add(change);

  EXPECT_EQ(reasons({0, 0.5, 0}, {{0, 0.5, 0}}), Reasons{});
  EXPECT_EQ(selection.rounds.size(), 2U);
}

// Such a rule belongs to no model without the term, and goes with it.
TEST_F(Pruning, WithdrawsARuleOfANamedTermBeforeTheTerm) {
  Candidate rule = friction("y");
  rule.adds.clear();
  rule.frees = {size_parameter("x.play")};
  rule.is_rule = true;
  add(friction("x"));
  add(rule);
  records = {pruned_record("fit", Use::Fit, {1, 1, 0}, 1),
             pruned_record("fit 2", Use::Fit, {1, 1, 0}, 2)};
  Problem problem = linear_problem(relation, records);
  finish(problem, two_records(), selection);

  EXPECT_TRUE(selection.ruled.free.empty());
  const auto withdrawn = withdraw_all(problem, two_records(), "unknown", selection);

  ASSERT_EQ(withdrawn.size(), 2U);
  EXPECT_EQ(withdrawn[0].candidate.name, "y");
  EXPECT_EQ(withdrawn[1].candidate.name, "x");
  EXPECT_TRUE(selection.rounds.empty());
}

TEST_F(Pruning, WithdrawsACandidateThatMakesAHeldOutRecordWorse) {
  add(friction("x"));
  add(friction("y"));

  EXPECT_EQ(reasons({0.5, 0.5, 0}, {{0.5, -0.5, 0}}),
            Reasons{"y: with it, unseen is predicted worse"});
}

// One record gains more than the other loses.
TEST_F(Pruning, DoesNotBalanceHeldOutRecords) {
  add(friction("x"));

  EXPECT_EQ(reasons({0.5, 0, 0}, {{2, 0, 0}, {-0.5, 0, 0}}),
            Reasons{"x: with it, unseen is predicted worse"});
}

// The energy of the error grows from 0.25 + 0.235² to 0.25 + 0.265², by 0.015: more than 2 % of
// itself, but less than 2 % of the noise, 1.
TEST_F(Pruning, KeepsACandidateThatMakesAHeldOutRecordWorseByLessThanNoise) {
  add(friction("x"));
  add(friction("y"));

  EXPECT_EQ(reasons({0.5, 0.5, 0}, {{0.5, 0.235, 0, 0.5}}), Reasons{});
}

// x is 0.5²/100² of the energy that the base does not predict: less than 10⁻³.
TEST_F(Pruning, WithdrawsACandidateThatHardlyHelps) {
  add(friction("x"));

  EXPECT_EQ(reasons({0.5, 0, 2}, {{0.5, 0, 100}}),
            Reasons{"x: it explains less than 0.1 % of the unseen records' error"});
}

// x is 4·10⁻⁴ of the energy of the error. y leaves four times the noise, which is all x.
TEST_F(Pruning, KeepsACandidateThatExplainsMostOfTheRest) {
  add(friction("y"));
  add(friction("x"));

  EXPECT_EQ(reasons({2, 100, 0}, {{2, 100, 0}}), Reasons{});
}

// y leaves 13 times the noise, of which x explains a third: it may be an error of the form of y.
TEST_F(Pruning, WithdrawsACandidateThatExplainsSomeOfTheRest) {
  add(friction("y"));
  add(friction("x"));

  EXPECT_EQ(reasons({2, 100, 3}, {{2, 100, 3}}),
            Reasons{"x: it explains less than 0.1 % of the unseen records' error"});
}

// x is 2.4 % of the energy of the error on the unseen record, and 4.8 % on the others.
TEST_F(Pruning, WithdrawsACorrectionOfTheFormThatExplainsLittle) {
  Candidate correction = friction("x");
  add(correction);
  EXPECT_EQ(reasons({0.5, 0, 2}, {{0.5, 0, 3}}), Reasons{});

  selection = {};
  records.clear(), held_records.clear();
  correction.corrects_form = true;
  add(correction);
  EXPECT_EQ(reasons({0.5, 0, 2}, {{0.5, 0, 3}}),
            Reasons{"x: it explains less than 5 % of the unseen records' error"});
}

// x is 0.5²/(0.5² + 14² + 1) = 1.3·10⁻³ of the energy that the base does not predict on the unseen
// record, and 5 % on the others.
TEST_F(Pruning, KeepsACandidateThatIsSmallBesideTheOthers) {
  add(friction("x"));

  EXPECT_EQ(reasons({0.5, 0, 2}, {{0.5, 0, 14}}), Reasons{});
}

// x explains 0.5²/(100² + 2·0.5² + 1) of the error of the base, but 0.5²/(2·0.5² + 1) of what y
// leaves. An error of the form of y may look like x, if it has one.
TEST_F(Pruning, MeasuresShareBesideAnEffectOfExactForm) {
  Candidate large = friction("y");
  for (const bool is_exact : {false, true}) {
    selection = {};
    records.clear(), held_records.clear();
    large.is_exact = is_exact;
    add(large);
    add(friction("x"));

    const auto withdrawn = reasons({0.5, 100, 0.5}, {{0.5, 100, 0.5}});

    EXPECT_EQ(withdrawn,
              is_exact ? Reasons{}
                       : Reasons{"x: it explains less than 0.1 % of the unseen records' error"});
  }
}

// The event hides on the unseen record what the others show.
TEST_F(Pruning, KeepsACandidateThatAnEventOfAHeldOutRecordHides) {
  add(friction("x"));

  EXPECT_EQ(reasons({0.5, 0, 0}, {{0.5, 0, 100}}), Reasons{});
}

TEST_F(Pruning, KeepsCandidatesThatHelpOnHeldOutRecords) {
  add(friction("x"));
  add(friction("y"));

  EXPECT_EQ(reasons({0.5, -1, 0}, {{0.5, -1, 0}}), Reasons{});
}

// Three times the noise of the displacement, 1.5, is the smallest gap that shows.
TEST_F(Pruning, WithdrawsAGapWithinTheNoiseOfTheDisplacement) {
  relation.driven_by = {"displacement.long"};
  Candidate play = friction("x");
  play.frees = {size_parameter("x.play")};
  play.frees[0].unit = "m";
  add(play);

  EXPECT_EQ(reasons({0, 0.4, 0}, {}),
            Reasons{"x: its size lies within the noise of the displacement"});
}

// It explains half of the energy, which noise of the displacement cannot.
TEST_F(Pruning, KeepsAGapWithinTheNoiseThatExplainsAQuarterOfTheError) {
  relation.driven_by = {"displacement.long"};
  Candidate play = friction("x");
  play.frees = {size_parameter("x.play")};
  play.frees[0].unit = "m";
  add(play);

  EXPECT_EQ(reasons({0, 1, 0}, {}), Reasons{});
}

// The time between samples is 50 ms. The shift of 2 ms is within a tenth of it: 2 ms - 1 s · 0.
TEST_F(Pruning, WithdrawsAShiftWithinASample) {
  Candidate skew = friction("x");
  skew.frees[0].unit = "s";
  skew.frees[0].absent = 0.998;
  add(skew);

  EXPECT_EQ(reasons({1, 0, 0}, {}),
            Reasons{"x: it shifts signals by less than a tenth of the time between samples"});
}

// A second size, of another unit, is no shift.
TEST_F(Pruning, KeepsADriftThatBeginsWithinASample) {
  Candidate drift = friction("x");
  drift.frees[0].unit = "s";
  drift.frees[0].absent = 0.998;
  drift.frees.push_back(size_parameter("y.coefficient"));
  drift.starts = {VectorXd::Zero(2)};
  add(drift);

  EXPECT_EQ(reasons({1, 0.5, 0}, {}), Reasons{});
}

// Under the peak of the measurement, about 1.4 + noise [N], a flexibility of 0.1 m/N gives less
// than 0.5 times the noise of the displacement, 0.5 m.
TEST_F(Pruning, WithdrawsAFlexibilityWithinTheNoiseOfTheDisplacement) {
  relation.driven_by = {"displacement.long"};
  Candidate flexible = friction("x");
  flexible.frees[0].unit = "m/N";
  add(flexible);

  EXPECT_EQ(reasons({0.03, 0, 0}, {}),
            Reasons{"x: its size lies within the noise of the displacement"});
}

TEST_F(Pruning, KeepsAGapBeyondTheNoiseOfTheDisplacement) {
  relation.driven_by = {"displacement.long"};
  Candidate play = friction("x");
  play.frees = {size_parameter("x.play")};
  play.frees[0].unit = "m";
  add(play);

  EXPECT_EQ(reasons({0, 2, 0}, {}), Reasons{});
}

}  // namespace
}  // namespace rths::diagnosis
