// SPDX-License-Identifier: Apache-2.0
//
// Headline and answers of a verdict.
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/report/diagnosis.hpp>

#include "example_verdict.hpp"
#include "support/files.hpp"
#include "support/readable.hpp"

namespace rths::report {
namespace {

using diagnosis::Answers, diagnosis::answers_of, diagnosis::Cause, diagnosis::Part,
    diagnosis::Verdict;
using test_support::missing_verdict;
using test_support::none_verdict;
using test_support::unknown_verdict;

std::string unreadable(const Verdict& verdict) {
  const Answers answers = answers_of(verdict);
  return test::unreadable(answers.headline, {answers.missing, answers.certainty, answers.next});
}

// Of the missing verdict, without its rival.
Verdict untied_verdict() {
  Verdict verdict = missing_verdict();
  verdict.conclusion.causes[0].alternatives.clear();
  return verdict;
}

Cause heating() {
  Cause cause;
  cause.name = "adiabatic_heating";
  cause.title = "strength that falls with dissipated work";
  cause.part = Part::Bearing;
  cause.channel = "force.long";
  cause.confidence = 0.9;
  cause.parameters = {{"adiabatic_heating.softening", "1/J", 1.21e-7, 1.17e-7, 1.25e-7, 0}};
  return cause;
}

TEST(Headline, SaysWhatIsMissingWhereAndHowMuchBetterItGets) {
  EXPECT_EQ(answers_of(untied_verdict()).headline,
            "Missing: Coulomb friction in the guides (machine, friction force 41 ± 0.7 kN); the "
            "force error falls 14-fold.");
}

TEST(Headline, NamesBothOfATie) {
  EXPECT_EQ(
      answers_of(missing_verdict()).headline,
      "Missing: one of two (machine): Coulomb friction in the guides or Friction that follows "
      "the vertical load; the force error falls from 9.1 % to 0.63 %.");
}

TEST(Headline, SaysThatNothingIsMissing) {
  EXPECT_EQ(answers_of(none_verdict()).headline,
            "Nothing is missing that these data can show: the error of 0.61 % is noise.");
}

TEST(Headline, SaysThatNoiseIsNotKnown) {
  Verdict verdict = none_verdict();
  verdict.evaluation.proof.is_noise_known = false;

  EXPECT_NE(answers_of(verdict).headline.find("but their noise is not known"), std::string::npos);
  EXPECT_EQ(answers_of(verdict).certainty.find("right in"), std::string::npos);
}

TEST(Headline, TellsTheVariableOfAnUnknownEffect) {
  EXPECT_EQ(answers_of(unknown_verdict()).headline,
            "Something is missing (machine) that depends on displacement, but no effect can be "
            "named; the force error stays at 6.8 %.");
}

TEST(Headline, CallsAChannelByAReadableName) {
  for (const auto& [label, called] :
       {std::pair{"auxiliary.pressure [Pa]", "pressure"},
        {"force.long [N]", "longitudinal force"},
        {"rate of auxiliary.oil_temperature [K]", "rate of oil temperature"}}) {
    Verdict verdict = unknown_verdict();
    verdict.descriptions[0].x_label = label;
    verdict.descriptions[0].form = "change of bouc_wen.yield_displacement at 1390.0 s";

    EXPECT_NE(answers_of(verdict).headline.find(std::string{" depends on "} + called + ","),
              std::string::npos)
        << answers_of(verdict).headline;
    EXPECT_NE(answers_of(verdict).missing.find("change of yield displacement at 1390.0 s"),
              std::string::npos)
        << answers_of(verdict).missing;
    EXPECT_EQ(unreadable(verdict), "");
  }
}

TEST(Headline, CallsATestedDeviceByItsKind) {
  Verdict verdict = untied_verdict();
  verdict.specimen = "device";

  EXPECT_NE(answers_of(verdict).headline.find("(device, "), std::string::npos);
  EXPECT_EQ(answers_of(verdict).missing.find("machine"), std::string::npos);
}

TEST(Headline, TellsAValuePerJouleAsItsInverse) {
  Verdict verdict = untied_verdict();
  verdict.conclusion.causes = {heating()};

  EXPECT_NE(answers_of(verdict).headline.find("softening over 8.3 ± 0.3 MJ"), std::string::npos)
      << answers_of(verdict).headline;
}

TEST(Headline, DoubtsRareNames) {
  Verdict verdict = untied_verdict();
  verdict.conclusion.causes[0].confidence = 0.3;

  EXPECT_EQ(answers_of(verdict).headline.rfind("Perhaps missing: ", 0), 0U);
}

TEST(Headline, DoubtsARareNameBesideASureOne) {
  Verdict verdict = untied_verdict();
  verdict.conclusion.causes.push_back(heating());
  verdict.conclusion.causes[1].confidence = 0.3;
  verdict.conclusion.has_remainder = true;

  const Answers answers = answers_of(verdict);

  EXPECT_EQ(answers.headline.rfind("Missing: Coulomb friction", 0), 0U) << answers.headline;
  EXPECT_NE(answers.headline.find("and perhaps "), std::string::npos) << answers.headline;
  EXPECT_NE(answers.missing.find("Perhaps strength that falls"), std::string::npos)
      << answers.missing;
}

TEST(Headline, TellsTheLawOfWhichGuessesAreParts) {
  Verdict verdict = untied_verdict();
  verdict.conclusion.causes.push_back(heating());
  for (auto& cause : verdict.conclusion.causes) cause.confidence = 0.3;
  verdict.conclusion.outcome = diagnosis::Outcome::Unknown;
  verdict.relations.emplace_back();
  verdict.relations[0].common_law = "f(v)";
  verdict.relations[0].has_remainder = true;
  verdict.descriptions = {{"f(v)", 0.97, "velocity [m/s]", {}, {}, {}}};
  verdict.descriptions[0].is_of_terms = true;

  const Answers answers = answers_of(verdict);

  EXPECT_EQ(answers.headline.rfind("Missing: an unknown law of the velocity, perhaps ", 0), 0U)
      << answers.headline;
  EXPECT_NE(answers.missing.find("draw an unknown law of the velocity."), std::string::npos);
  EXPECT_EQ(answers.missing.find("It depends on"), std::string::npos) << answers.missing;
  EXPECT_EQ(unreadable(verdict), "");
}

TEST(Headline, SaysThatMoreIsMissing) {
  Verdict verdict = untied_verdict();
  verdict.conclusion.has_remainder = true;

  EXPECT_NE(answers_of(verdict).headline.find("but more is missing."), std::string::npos);
}

TEST(Headline, TellsAnErrorThatUnseenDataDoNotConfirm) {
  Verdict verdict = untied_verdict();
  verdict.evaluation.proof.after = 0.1;

  EXPECT_NE(answers_of(verdict).headline.find("on unseen data does not fall"), std::string::npos);
}

TEST(Headline, StaysShortWithManyCausesAndRivals) {
  for (std::size_t causes = 1; causes <= 6; ++causes)
    for (std::size_t rivals = 0; rivals <= 5; ++rivals) {
      Verdict verdict = missing_verdict();
      Cause cause = heating();
      cause.alternatives.assign(rivals, {"velocity_dependent_friction",
                                         "friction that grows smoothly with velocity", 1, "", 0});
      verdict.conclusion.causes.assign(causes, cause);
      verdict.conclusion.has_remainder = true;

      EXPECT_EQ(unreadable(verdict), "") << causes << " causes, " << rivals << " rivals";
    }
}

TEST(Answers, AreReadable) {
  for (Verdict verdict : {missing_verdict(), none_verdict(), unknown_verdict()}) {
    EXPECT_EQ(unreadable(verdict), "");
    verdict.evaluation.proof.before = verdict.evaluation.proof.after = 2.5;  // times the signal
    EXPECT_EQ(unreadable(verdict), "");
    verdict.evaluation.proof_record = "";
    verdict.conclusion.has_remainder = true;
    EXPECT_EQ(unreadable(verdict), "");
  }
  const Answers empty = answers_of(Verdict{});
  EXPECT_FALSE(empty.headline.empty());
}

TEST(Answers, TellHowOftenSuchANameIsRight) {
  Verdict verdict = untied_verdict();
  for (const auto& [confidence, expected] : {std::pair{0.99, "19 of 20 cases"},
                                             {0.9, "9 of 10 cases"},
                                             {0.6, "6 of 10 cases"},
                                             {0.2, "2 of 10 cases"},
                                             {0.05, "less than 1 of 10 cases"}}) {
    verdict.conclusion.causes[0].confidence = confidence;

    EXPECT_NE(answers_of(verdict).certainty.find(expected), std::string::npos)
        << confidence << answers_of(verdict).certainty;
  }
}

TEST(Answers, TellTheNextTestOfATie) {
  const Answers answers = answers_of(missing_verdict());

  EXPECT_NE(answers.next.find("Run the next test: empty table, sine of 0.5 Hz"), std::string::npos);
  EXPECT_NE(answers.missing.find("Or instead of it: Friction that follows the vertical load"),
            std::string::npos);
}

TEST(Answers, ListWhatWasSelectedAndIsNotNamed) {
  Verdict verdict = unknown_verdict();
  verdict.conclusion.withdrawn = {"quadratic drag", "viscous friction"};

  EXPECT_NE(answers_of(verdict).missing.find("not named: quadratic drag and viscous friction."),
            std::string::npos);
}

}  // namespace
}  // namespace rths::report
