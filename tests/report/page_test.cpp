// SPDX-License-Identifier: Apache-2.0
//
// The report's page in a real browser, without a network.
#include <cstdlib>

#include <gtest/gtest.h>

#include "browser.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::report {
namespace {

/// The page of a short run, and what Chromium makes of it.
class Page : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new test::TemporaryFolder;
    const auto example = (test::source_tree() / "examples/srmd_lprb_2d.toml").string();
    const test::Finished run = test::run_rths({"run", example, "--clock", "virtual", "--out",
                                               folder->path().string(), "--set", "duration_s=10"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    html = test::content_of(folder->path() / "report.html");
  }
  static void TearDownTestSuite() {
    delete folder;
    folder = nullptr;
  }

  static test::TemporaryFolder* folder;
  static std::string html;
};
test::TemporaryFolder* Page::folder = nullptr;
std::string Page::html;

TEST_F(Page, NeedsNothingFromTheNetwork) {
  for (const char* reference : {"src=\"http", "href=\"http", "url(http", "@import", "fetch("})
    EXPECT_EQ(html.find(reference), std::string::npos) << reference;
  EXPECT_LT(html.size(), 3'000'000U);
}

TEST_F(Page, CarriesThePlottingLibraryWithItsCopyright) {
  EXPECT_NE(html.find("Leon Sorokin"), std::string::npos);
}

TEST_F(Page, SaysThatItsDataIsSynthetic) {
  EXPECT_NE(html.find("synthetic specimen and machine"), std::string::npos);
  EXPECT_NE(html.find("fillText(\"synthetic\""), std::string::npos);
}

TEST_F(Page, DrawsEveryFigureInChromiumWithoutAnError) {
  if (!std::filesystem::exists(test_support::kBrowser))
    GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";

  const std::string page =
      test_support::rendered(folder->path() / "report.html", folder->path() / "profile");

  // Two loops, orbit, interaction; two displacements, delay, error; three coefficients; states;
  // three spectra. Lateness is drawn for runs in real time only.
  EXPECT_EQ(test_support::body_of(page), "<body data-figures=\"15\">");
  EXPECT_NE(page.find("<h1 id=\"title\">srmd lprb 2d</h1>"), std::string::npos);
  EXPECT_NE(page.find("no slow-downs"), std::string::npos);
}

}  // namespace
}  // namespace rths::report
