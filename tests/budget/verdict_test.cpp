// SPDX-License-Identifier: Apache-2.0
//
// The mismatch budget in a verdict.
#include <gtest/gtest.h>

#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {
namespace {

budget::MismatchBudget budget_with(double error) {
  budget::MismatchBudget found;
  budget::AxisBudget axis;
  axis.name = "long";
  axis.transfer.error = error;
  axis.transfer.error_without = 0.4;
  axis.transfer.confidence = 0.8;
  axis.transfer.parameters = {{"gain", "1/s", 20, 0.1}};
  axis.tracking = 0.18;
  axis.before = 0.3;
  axis.after = 0.01;
  axis.share = {0.9, 0, 0, 0, 0.099};
  axis.remainder = 0.001;
  found.axes = {axis};
  return found;
}

Verdict unknown_in(Part part) {
  Verdict verdict;
  verdict.outcome = Outcome::Unknown;
  verdict.where.part = part;
  Cause spurious;
  spurious.name = "oil_column";
  spurious.part = Part::Actuator;
  verdict.causes = {spurious};
  verdict.sentence = "Unknown.";
  verdict.fragment = "[machine.oil_column]";
  return verdict;
}

TEST(BudgetOfAVerdict, NamesTheTransferSystemOfAnUnknownActuator) {
  Verdict verdict = unknown_in(Part::Actuator);
  add_budget(budget_with(0.002), verdict);

  EXPECT_EQ(verdict.outcome, Outcome::Missing);
  ASSERT_EQ(verdict.causes.size(), 1U);
  EXPECT_EQ(verdict.causes[0].name, "transfer_system");
  EXPECT_NEAR(verdict.causes[0].explained, 1 - 0.002 * 0.002 / (0.4 * 0.4), 1e-12);
  EXPECT_EQ(verdict.causes[0].parameters[0].name, "transfer_system_long.gain");
  EXPECT_EQ(verdict.fragment, "");
  EXPECT_EQ(verdict.confidence, 0.8);
  EXPECT_NE(verdict.sentence.find("18 % rms"), std::string::npos) << verdict.sentence;
}

TEST(BudgetOfAVerdict, NamesNoTransferSystemThatDoesNotPredict) {
  Verdict verdict = unknown_in(Part::Actuator);
  add_budget(budget_with(0.1), verdict);

  EXPECT_EQ(verdict.outcome, Outcome::Unknown);
  EXPECT_EQ(verdict.causes[0].name, "oil_column");
}

TEST(BudgetOfAVerdict, LeavesOtherVerdictsAndTellsTheShares) {
  Verdict verdict = unknown_in(Part::Bearing);
  add_budget(budget_with(0.002), verdict);

  EXPECT_EQ(verdict.outcome, Outcome::Unknown);
  EXPECT_EQ(verdict.sentence,
            "Unknown. The response of the test differs from that of the simulation by 30 % rms "
            "(long): tracking of the machine 90 %, the numerical side 10 %, remainder 0.1 % of it. "
            "With all parts as identified the difference is 1 %.");
}

TEST(BudgetOfAVerdict, ChangesNothingIfItIsEmpty) {
  Verdict verdict = unknown_in(Part::Actuator);
  add_budget({}, verdict);

  EXPECT_EQ(verdict.sentence, "Unknown.");
}

}  // namespace
}  // namespace rths::diagnosis
