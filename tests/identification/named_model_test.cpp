// SPDX-License-Identifier: Apache-2.0
#include "named_model.hpp"

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kStart = 3, kCurrent = 5;

const auto is_any = [](const SelectionRound&) { return true; };

// A rule of drag, as a rival that took the place of a candidate before drag.
std::vector<SelectionRound> rule_before_its_term() {
  Candidate rule = friction("rule");
  rule.adds.clear();
  rule.becomes = {{"drag", "quadratic_drag"}};
  rule.frees = {size_parameter("drag.exponent")};
  std::vector<SelectionRound> rounds;
  for (Candidate candidate : {rule, friction("gain"), friction("drag")}) {
    candidate.starts = {VectorXd::Constant(1, kStart)};
    rounds.push_back({{candidate, {}, 0, {}, 0, 0, 0}, {}, {}});
  }
  return rounds;
}

std::vector<std::string> free_of(const Hypothesis& hypothesis) {
  std::vector<std::string> names;
  for (const auto& free : hypothesis.free) names.push_back(free.name);
  return names;
}

TEST(ModelOfRounds, ChangesATermThatALaterRoundAdds) {
  const Hypothesis base = linear_model({"mass"}, {7});
  const Hypothesis current = linear_model({"mass", "drag.exponent"}, {8, kCurrent});

  const Hypothesis all = with_rounds(base, rule_before_its_term(), is_any, current);

  EXPECT_EQ(free_of(all), (std::vector<std::string>{"mass", "gain.coefficient", "drag.coefficient",
                                                    "drag.exponent"}));
  EXPECT_EQ(all.values, (VectorXd{{8, kStart, kStart, kCurrent}}));
  ASSERT_EQ(all.terms.size(), 2U);
  EXPECT_EQ(all.terms[1].settings.kind, "quadratic_drag");
}

TEST(ModelOfRounds, LeavesOutWhatChangesATermThatIsLeftOut) {
  const Hypothesis base = linear_model({"mass"}, {7});
  const auto rounds = rule_before_its_term();
  const auto is_no_drag = [](const SelectionRound& round) {
    return round.chosen.candidate.name != "drag";
  };

  const Hypothesis rest = with_rounds(base, rounds, is_no_drag, base);

  EXPECT_EQ(free_of(rest), (std::vector<std::string>{"mass", "gain.coefficient"}));
}

TEST(Selection, ExplainsTheShareOfTheExcess) {
  Selection selection;
  selection.variance_base = 5;
  selection.variance_named = 2;
  EXPECT_DOUBLE_EQ(selection.explained(), 0.75);
  selection.variance_named = 6;
  EXPECT_EQ(selection.explained(), 0);
  selection.variance_base = 1;
  EXPECT_EQ(selection.explained(), 0);
}

}  // namespace
}  // namespace rths::diagnosis
