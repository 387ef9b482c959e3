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
  axis.axis = Axis::Long;
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
  verdict.conclusion.outcome = Outcome::Unknown;
  verdict.conclusion.where.part = part;
  Cause spurious;
  spurious.name = "actuator_delay";
  spurious.part = Part::Actuator;
  verdict.conclusion.causes = {spurious};
  verdict.sentence = "Unknown.";
  verdict.improvement.fragment = "[machine.actuator_delay]";
  return verdict;
}

TEST(BudgetOfAVerdict, NamesTheTransferSystemOfAnUnknownActuator) {
  Verdict verdict = unknown_in(Part::Actuator);
  add_budget(budget_with(0.002), verdict);

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Missing);
  ASSERT_EQ(verdict.conclusion.causes.size(), 1U);
  EXPECT_EQ(verdict.conclusion.causes[0].name, "transfer_system");
  EXPECT_NEAR(verdict.conclusion.causes[0].explained, 1 - 0.002 * 0.002 / (0.4 * 0.4), 1e-12);
  EXPECT_EQ(verdict.conclusion.causes[0].parameters[0].name, "transfer_system_long.gain");
  EXPECT_EQ(verdict.improvement.fragment, "");
  EXPECT_EQ(verdict.conclusion.confidence, 0.8);
  EXPECT_NE(verdict.sentence.find("18 % rms"), std::string::npos) << verdict.sentence;
}

/// An unknown actuator, and a force with a cause and a residual of its own.
Verdict with_two_relations() {
  Verdict verdict = unknown_in(Part::Actuator);
  Cause friction;
  friction.name = "coulomb_friction";
  friction.title = "Coulomb friction";
  friction.part = Part::Machine;
  friction.channel = "force";
  friction.confidence = 0.7;
  verdict.conclusion.causes.push_back(friction);
  verdict.conclusion.unexplained = {"displacement", "force"};
  Description of_displacement, of_force;
  of_displacement.form = "f(v)";
  of_displacement.channel = "displacement";
  of_force.form = "f(u)";
  of_force.share = 0.6;
  of_force.channel = "force";
  verdict.descriptions = {of_displacement, of_force};
  verdict.improvement.fragment =
      "[machine.actuator_delay]\nkind = \"actuator_delay\"\ndelay_s = 0.01\n\n"
      "[machine.coulomb_friction]\nkind = \"coulomb_friction\"\nfriction_force_N = 100.0\n\n";
  verdict.improvement.source.file = Config::parse(
      "[model]\nkind = \"platen\"\n"
      "fitted = [\"actuator_delay.delay\", \"coulomb_friction.friction_force\"]\n"
      "[model.bounds]\n\"actuator_delay.delay\" = [0, 1]\n"
      "[model.actuator_delay]\nkind = \"actuator_delay\"\ndelay_s = 0.01\n"
      "[model.coulomb_friction]\nfriction_force_N = 100.0\n",
      "case.toml");
  return verdict;
}

TEST(BudgetOfAVerdict, KeepsCausesFormsAndRemainderOfTheForce) {
  Verdict verdict = with_two_relations();
  add_budget(budget_with(0.002), verdict);

  ASSERT_EQ(verdict.conclusion.causes.size(), 2U);
  EXPECT_EQ(verdict.conclusion.causes[1].name, "coulomb_friction");
  EXPECT_EQ(verdict.conclusion.confidence, 0.7);
  EXPECT_TRUE(verdict.conclusion.has_remainder);
  ASSERT_EQ(verdict.descriptions.size(), 1U);
  EXPECT_EQ(verdict.descriptions[0].form, "f(u)");
  EXPECT_EQ(verdict.sentence.find("Missing: tracking of the transfer system (actuator) and Coulomb "
                                  "friction (machine): the displacement differs"),
            0U)
      << verdict.sentence;
  EXPECT_NE(verdict.sentence.find(
                "; the residual of force is systematic, and none of the terms that were searched "
                "explains it; its best form is f(u), which explains "
                "60 % of it"),
            std::string::npos)
      << verdict.sentence;
}

TEST(BudgetOfAVerdict, WithdrawsTermsOfTheActuatorFromTheImprovedModels) {
  Verdict verdict = with_two_relations();
  add_budget(budget_with(0.002), verdict);

  EXPECT_EQ(
      verdict.improvement.fragment,
      "[machine.coulomb_friction]\nkind = \"coulomb_friction\"\nfriction_force_N = 100.0\n\n");
  const Config model = verdict.improvement.source.file.table("model");
  EXPECT_FALSE(model.has("actuator_delay"));
  EXPECT_TRUE(model.has("coulomb_friction"));
  EXPECT_EQ(model.texts("fitted"), (std::vector<std::string>{"coulomb_friction.friction_force"}));
  EXPECT_TRUE(model.table("bounds").keys().empty());
}

TEST(BudgetOfAVerdict, HasNoRemainderIfOnlyTheActuatorWasUnknown) {
  Verdict verdict = unknown_in(Part::Actuator);
  verdict.conclusion.unexplained = {"displacement"};
  add_budget(budget_with(0.002), verdict);

  EXPECT_FALSE(verdict.conclusion.has_remainder);
  EXPECT_EQ(verdict.sentence.find("the residual of"), std::string::npos) << verdict.sentence;
}

// The errors of the diagnosis are those of filtered signals.
TEST(BudgetOfAVerdict, ComparesErrorsOfOneDefinition) {
  Verdict verdict = unknown_in(Part::Actuator);
  verdict.evaluation.proof.before = 0.05;
  verdict.evaluation.proof.floor = 1e-4;
  RecordScore fitted, unseen;
  fitted.use = "fit";
  unseen.use = "held_out";
  fitted.nrmse_before = unseen.nrmse_before = 0.05;
  verdict.evaluation.fit = {fitted, unseen};
  auto found = budget_with(0.002);
  found.axes[0].held_out = 0.003;
  found.axes[0].held_out_without = 0.5;
  found.axes[0].noise = 0.001;

  add_budget(found, verdict);

  EXPECT_EQ(verdict.evaluation.fit[0].nrmse_before, 0.4);
  EXPECT_EQ(verdict.evaluation.fit[0].nrmse_after, 0.002);
  EXPECT_EQ(verdict.evaluation.fit[1].nrmse_before, 0.5);
  EXPECT_EQ(verdict.evaluation.fit[1].nrmse_after, 0.003);
  EXPECT_EQ(verdict.evaluation.fit[1].noise_floor, 0.001);
  EXPECT_EQ(verdict.evaluation.proof.before, 0.5);
  EXPECT_EQ(verdict.evaluation.proof.after, 0.003);
  EXPECT_EQ(verdict.evaluation.proof.floor, 0.001);
  EXPECT_NEAR(verdict.evaluation.proof.explained, (0.25 - 9e-6) / (0.25 - 1e-6), 1e-12);
  EXPECT_EQ(verdict.conclusion.causes[0].explained, verdict.evaluation.proof.explained);
}

TEST(BudgetOfAVerdict, NamesNoTransferSystemThatDoesNotPredict) {
  Verdict verdict = unknown_in(Part::Actuator);
  add_budget(budget_with(0.1), verdict);

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Unknown);
  EXPECT_EQ(verdict.conclusion.causes[0].name, "actuator_delay");
}

TEST(BudgetOfAVerdict, LeavesOtherVerdictsAndTellsTheShares) {
  Verdict verdict = unknown_in(Part::Bearing);
  add_budget(budget_with(0.002), verdict);

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::Unknown);
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
