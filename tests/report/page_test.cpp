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

  const test::SharedRun run = test::short_run();
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

  // Two loops, orbit, interaction; two displacements, delay, error; three coefficients; states;
  // three spectra. Only runs in real time have a figure of late steps.
  EXPECT_EQ(test_support::body_of(page), "<body data-figures=\"15\">");
  EXPECT_NE(page.find("<h1 id=\"title\">srmd lprb 2d</h1>"), std::string::npos);
  EXPECT_NE(page.find("no slow-downs"), std::string::npos);
}

}  // namespace
}  // namespace rths::report
