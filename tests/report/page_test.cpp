// SPDX-License-Identifier: Apache-2.0
//
// The report's page in a real browser, without a network.
#include <cstdlib>

#include <gtest/gtest.h>

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

  // The document after its scripts have run.
  static std::string rendered() {
    const std::string profile = (folder->path() / "profile").string();
    return test::Running{{"/usr/bin/chromium", "--headless", "--no-sandbox", "--disable-gpu",
                          "--disable-quic", "--no-first-run", "--disable-background-networking",
                          "--disable-component-update", "--disable-sync",
                          "--user-data-dir=" + profile, "--virtual-time-budget=8000", "--dump-dom",
                          "file://" + (folder->path() / "report.html").string()}}
        .wait(60)
        .out;
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
  if (!std::filesystem::exists("/usr/bin/chromium"))
    GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";

  const std::string page = rendered();

  // Two loops, orbit, interaction; two displacements, delay, error; three coefficients; states;
  // three spectra. Lateness is drawn for runs in real time only.
  const std::string body = page.substr(page.find("<body"), 200);
  EXPECT_EQ(body.rfind("<body data-figures=\"15\">", 0), 0U) << body;
  EXPECT_NE(page.find("<h1 id=\"title\">srmd lprb 2d</h1>"), std::string::npos);
  EXPECT_NE(page.find("no slow-downs"), std::string::npos);
}

}  // namespace
}  // namespace rths::report
