// SPDX-License-Identifier: Apache-2.0
//
// The diagnosis page, in a real browser if one is installed.
#include <cmath>

#include <gtest/gtest.h>

#include <rths/report/diagnosis.hpp>

#include "browser.hpp"
#include "example_verdict.hpp"
#include "support/files.hpp"

namespace rths::report {
namespace {

using test_support::body_of;
using test_support::missing_verdict;
using test_support::none_verdict;
using test_support::unknown_verdict;

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(VerdictPage, NeedsNothingFromTheNetwork) {
  const std::string page = verdict_page(missing_verdict());

  for (const char* reference : {"src=\"http", "href=\"http", "url(http", "@import", "fetch("})
    EXPECT_FALSE(holds(page, reference)) << reference;
  EXPECT_LT(page.size(), 1'000'000U);
}

TEST(VerdictPage, StaysSmallWithManyLongRecords) {
  diagnosis::Verdict verdict = missing_verdict();
  for (auto* values : {&verdict.evaluation.traces[0].time, &verdict.evaluation.traces[0].abscissa,
                       &verdict.evaluation.traces[0].measured, &verdict.evaluation.traces[0].before,
                       &verdict.evaluation.traces[0].after, &verdict.evaluation.traces[0].excess})
    values->resize(100'000);
  verdict.evaluation.traces.resize(30, verdict.evaluation.traces[0]);

  EXPECT_LT(verdict_page(verdict).size(), 3'000'000U);
}

TEST(VerdictPage, EscapesMarkupInTextsOfACase) {
  diagnosis::Verdict verdict = none_verdict();
  verdict.case_name = "</script><script>alert(1)</script><!--";
  verdict.limits = {"/*script*/ \xff"};

  const std::string page = verdict_page(verdict);

  EXPECT_FALSE(holds(page, "alert(1)</script>"));
  EXPECT_TRUE(holds(page, "\\u003c/script>\\u003cscript>alert(1)"));
  EXPECT_TRUE(holds(page, "/*script*/ \uFFFD"));
}

/// The page of a verdict, rendered by Chromium.
class RenderedVerdict : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(test_support::kBrowser))
      GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";
  }
  std::string rendered(const diagnosis::Verdict& verdict) {
    const auto written = write_diagnosis(verdict, folder_.path());
    const std::string page = test_support::rendered(written.page, folder_.path() / "profile");
    return page.substr(0, page.find("<script>"));  // the visible document without its scripts
  }
  static bool is_hidden(const std::string& page, const std::string& section) {
    return holds(page, "<section id=\"" + section + "\" hidden=\"\">");
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(RenderedVerdict, ShowsPlaceNameModelAndProofOfTheCause) {
  const std::string page = rendered(missing_verdict());

  // Time, loops, states, two profiles; loops, history, residual, correlation.
  EXPECT_EQ(body_of(page), "<body data-figures=\"9\">");
  EXPECT_TRUE(holds(page, "<div class=\"guilty\">Machine<small>force.long</small></div>"));
  EXPECT_TRUE(holds(page, "F = Fc · tanh(v / vs)"));
  EXPECT_TRUE(holds(page, ">41.20</td><td class=\"\">40.50 to 41.90</td><td class=\"text\">kN"));
  EXPECT_TRUE(holds(page, "friction_force_N = 41_200"));
  EXPECT_TRUE(holds(page, "type=\"range\""));
  EXPECT_TRUE(holds(page, "9.10\u2009%"));
  EXPECT_TRUE(holds(page, "218 σ"));
  EXPECT_TRUE(holds(page, "No vertical force was recorded"));
  EXPECT_TRUE(is_hidden(page, "form"));
}

TEST_F(RenderedVerdict, BeginsWithTheHeadlineAndThreeAnswers) {
  const std::string page = rendered(missing_verdict());
  const auto answers = answers_of(missing_verdict());

  EXPECT_TRUE(holds(page, "class=\"sentence\">" + answers.headline + "</h1>"));
  for (const auto& answer : {answers.missing, answers.certainty, answers.next})
    EXPECT_TRUE(holds(page, "<p>" + answer + "</p>")) << answer;
  EXPECT_FALSE(holds(page, "<details open=\"\""));
}

TEST_F(RenderedVerdict, CallsATestedDeviceByItsKind) {
  diagnosis::Verdict verdict = missing_verdict();
  verdict.specimen = "device";

  const std::string page = rendered(verdict);

  EXPECT_TRUE(holds(page, "<div class=\"guilty\">Device<small>force.long</small></div>"));
  EXPECT_FALSE(holds(page, ">Machine<"));
  EXPECT_FALSE(holds(page, ">Bearing<"));
}

TEST_F(RenderedVerdict, ShowsNoPlaceAndNoModelWhereNothingIsMissing) {
  const std::string page = rendered(none_verdict());

  EXPECT_EQ(body_of(page), "<body data-figures=\"4\">");
  EXPECT_TRUE(holds(page, "<span class=\"chip none\">nothing missing</span>"));
  for (const char* section : {"where", "form", "model", "rivals"})
    EXPECT_TRUE(is_hidden(page, section)) << section;
  EXPECT_FALSE(holds(page, "type=\"range\""));
}

TEST_F(RenderedVerdict, ShowsTheFormOfAnUnknownCause) {
  const std::string page = rendered(unknown_verdict());

  EXPECT_EQ(body_of(page), "<body data-figures=\"10\">");
  EXPECT_FALSE(is_hidden(page, "form"));
  EXPECT_TRUE(is_hidden(page, "model"));
  EXPECT_TRUE(holds(page, "f(u) with its band"));
  EXPECT_TRUE(holds(page, "empty table, triangle of 20 mm/s"));
}

TEST_F(RenderedVerdict, ShowsTheFormOfTheRemainderBesideACause) {
  diagnosis::Verdict verdict = missing_verdict();
  verdict.descriptions = unknown_verdict().descriptions;

  const std::string page = rendered(verdict);

  EXPECT_FALSE(is_hidden(page, "form"));
  EXPECT_TRUE(holds(page, ">Form of the remainder<"));
}

TEST_F(RenderedVerdict, CallsALawByAllTheGuessesThatDrawIt) {
  diagnosis::Verdict verdict = missing_verdict();
  verdict.descriptions = unknown_verdict().descriptions;
  verdict.descriptions[0].is_of_terms = true;
  verdict.descriptions[0].band.clear();

  const std::string page = rendered(verdict);

  EXPECT_TRUE(holds(page, ">Form of all guessed causes together<"));
  EXPECT_TRUE(holds(page, "f(u) of all guessed causes together"));
  EXPECT_FALSE(holds(page, "with its band"));
}

TEST_F(RenderedVerdict, ShowsTheIntervalsOfTheImprovedResponse) {
  diagnosis::Verdict verdict = missing_verdict();
  EXPECT_TRUE(is_hidden(rendered(verdict), "bands"));
  verdict.bands = test_support::example_bands();

  const std::string page = rendered(verdict);

  EXPECT_EQ(body_of(page), "<body data-figures=\"10\">");
  EXPECT_FALSE(is_hidden(page, "bands"));
  EXPECT_TRUE(holds(page, ">212.5</td><td class=\"\">208.5 to 216.5</td><td class=\"text\">mm"));
  EXPECT_TRUE(holds(page, "and the remaining error of the force, by 21 simulations"));
}

TEST_F(RenderedVerdict, OffersThePredictionWithoutEachCause) {
  diagnosis::Verdict verdict = missing_verdict();
  EXPECT_FALSE(holds(rendered(verdict), "Left out before"));
  for (auto& trace : verdict.evaluation.traces)
    trace.without = {{"coulomb_friction", trace.before}, {"lead_heating", trace.stated}};

  const std::string page = rendered(verdict);

  EXPECT_TRUE(holds(page, "Left out before: "));
  EXPECT_TRUE(holds(page, "lead heating alone"));
  EXPECT_EQ(body_of(page), body_of(rendered(missing_verdict())));
}

TEST_F(RenderedVerdict, MarksOnlySyntheticDataAsSynthetic) {
  diagnosis::Verdict verdict = none_verdict();
  EXPECT_TRUE(holds(rendered(verdict), "synthetic recordings"));

  verdict.synthetic = false;

  EXPECT_FALSE(holds(rendered(verdict), "synthetic recordings"));
}

TEST_F(RenderedVerdict, SaysWhoseEnergyThePlaceHolds) {
  diagnosis::Verdict verdict = missing_verdict();
  EXPECT_TRUE(holds(rendered(verdict), "Energy of the residual beyond the noise"));

  verdict.conclusion.where.is_of_named = true;

  const std::string page = rendered(verdict);
  EXPECT_TRUE(holds(page, "Energy of the contribution of the named terms to the prediction"));
  EXPECT_FALSE(holds(page, "Energy of the residual beyond the noise"));
}

TEST_F(RenderedVerdict, DrawsWithOptionalDataMissing) {
  diagnosis::Verdict verdict = missing_verdict();
  verdict.evaluation.proof_record = "";
  verdict.evaluation.traces.resize(1);
  verdict.evaluation.traces[0].abscissa.clear();
  verdict.evaluation.traces[0].excess.clear();
  verdict.conclusion.where.profiles.clear();
  verdict.conclusion.where.state_map.clear();
  verdict.evaluation.residual.bound = 0;
  verdict.improvement.fragment.clear();

  const std::string page = rendered(verdict);

  // States; history, residual, correlation.
  EXPECT_EQ(body_of(page), "<body data-figures=\"4\">");
  EXPECT_TRUE(holds(page, "No record was held out: the following is not a proof."));
}

TEST_F(RenderedVerdict, AnswersQuestionsInTheDarkOnPaperAndOnATelephone) {
  const test::TemporaryFolder folder;

  const std::string answers = test_support::probed(
      verdict_page(missing_verdict()),
      "{ loops: 'Loops', time: 'Time history', beside: 'Residual', "
      "chart: 'Frequency, in third octaves', "
      "pairs: [['before', 'after'], ['measured', 'before'], ['measured', 'after']] }",
      folder);

  for (const auto& answer : test_support::kAnswers)
    EXPECT_TRUE(holds(answers, "\n" + answer + "\n")) << answer << answers;
  EXPECT_FALSE(holds(answers, "alike: ")) << answers;
  EXPECT_TRUE(holds(answers, "kNat ")) << answers;
  EXPECT_TRUE(holds(answers, "predicted before")) << answers;
  EXPECT_TRUE(holds(answers, "chart tells: ")) << answers;
  EXPECT_FALSE(holds(answers, "tells: nothing")) << answers;
}

TEST_F(RenderedVerdict, DrawsAnEmptyVerdict) {
  EXPECT_EQ(body_of(rendered(diagnosis::Verdict{})), "<body data-figures=\"0\">");
}

}  // namespace
}  // namespace rths::report
