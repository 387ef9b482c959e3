// SPDX-License-Identifier: Apache-2.0
//
// The report page in a real browser, without a network.
#include <gtest/gtest.h>

#include "browser.hpp"
#include "support/files.hpp"
#include "support/shared_run.hpp"

namespace rths::report {
namespace {

/// The report page of a short run.
class Page : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(run.is_made()) << run.path << ": ctest makes this run before the test";
    html = test::content_of(file());
  }
  [[nodiscard]] std::filesystem::path file() const { return run.path / "report.html"; }

  const test::SharedRun run = test::shared_run();
  std::string html;
};

TEST_F(Page, NeedsNothingFromTheNetwork) {
  for (const char* reference : {"src=\"http", "href=\"http", "url(http", "@import", "fetch("})
    EXPECT_EQ(html.find(reference), std::string::npos) << reference;
  EXPECT_LT(html.size(), 3'000'000U);
}

TEST_F(Page, CarriesThePlottingLibraryWithItsCopyright) {
  EXPECT_NE(html.find("Leon Sorokin"), std::string::npos);
}

TEST_F(Page, MarksItsDataAsSynthetic) {
  EXPECT_NE(html.find("synthetic specimen and machine"), std::string::npos);
  EXPECT_NE(html.find("fillText(\"synthetic\""), std::string::npos);
}

TEST_F(Page, DrawsEveryFigureInChromiumWithoutAnError) {
  if (!std::filesystem::exists(test_support::kBrowser))
    GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";

  const test::TemporaryFolder profile;
  const std::string page = test_support::rendered(file(), profile.path());

  // Two loops, orbit, interaction; response and difference of two axes; two displacements, delay,
  // error; three coefficients; states;
  // three spectra. Only runs in real time have a figure of late steps.
  EXPECT_EQ(test_support::body_of(page), "<body data-figures=\"19\">");
  EXPECT_NE(page.find("<h1 id=\"title\">srmd lprb 2d</h1>"), std::string::npos);
  EXPECT_NE(page.find("no slow-downs"), std::string::npos);
  EXPECT_NE(page.find("Difference from the test, longitudinal"), std::string::npos);
  EXPECT_NE(page.find("save this figure as SVG"), std::string::npos);
}

// Replaces a text of the page, which must be there.
void change(std::string& html, const std::string& from, const std::string& to) {
  const auto at = html.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  html.replace(at, from.size(), to);
}

TEST_F(Page, AnswersQuestionsInTheDarkOnPaperAndOnATelephone) {
  if (!std::filesystem::exists(test_support::kBrowser))
    GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";
  change(html, "\"operator_changes\":[]",
         "\"operator_changes\":[{\"time_s\":6.0,\"signal\":\"tune.xpc.ats.enabled\",\"unit\":\"1\","
         "\"from\":1.0,\"to\":0.0}]");
  const test::TemporaryFolder folder;

  const std::string answers = test_support::probed(
      html,
      "{ loops: 'Hysteresis, longitudinal', time: 'Displacement, longitudinal', "
      "beside: 'Tracking delay', mark: true, "
      "pairs: [['hybrid', 'numerical'], ['hybrid', 'improved'], ['numerical', 'improved'], "
      "['hybrid', 'fixed-base'], ['numerical', 'fixed-base'], ['improved', 'fixed-base'], "
      "['long', 'lat'], ['command', 'hybrid'], ['correct', 'slow']] }",
      folder);

  for (const auto& answer : test_support::kAnswers)
    EXPECT_NE(answers.find("\n" + answer + "\n"), std::string::npos) << answer << answers;
  EXPECT_EQ(answers.find("alike: "), std::string::npos) << answers;
  EXPECT_NE(answers.find("mmshear force"), std::string::npos) << answers;
  EXPECT_NE(answers.find("mmmeasured"), std::string::npos) << answers;
  EXPECT_NE(answers.find("mstune.xpc.ats.enabled: 1 → 0"), std::string::npos) << answers;
}

}  // namespace
}  // namespace rths::report
