// SPDX-License-Identifier: Apache-2.0
//
// The page of a comparison in a real browser, without a network.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/report/comparison.hpp>

#include "browser.hpp"
#include "support/files.hpp"

namespace rths::report {
namespace {

class ComparisonPage : public ::testing::Test {
 protected:
  /// Ten thousand rows of two signals; one row of the first differs by 5 mm.
  [[nodiscard]] std::filesystem::path table(const char* name, double once) const {
    std::string text = "time [s],displ [m],force [kN]\n";
    for (int i = 0; i < 10'000; ++i)
      text +=
          fmt::format("{:.3f},{:.9g},{:.9g}\n", 0.001 * i,
                      0.05 * std::sin(0.01 * i) + (i == 5003 ? once : 0), 10 * std::cos(0.01 * i));
    return folder_.write(name, text);
  }
  [[nodiscard]] std::string page(double once) const {
    const auto found = compare(table("a.csv", 0), table("<script>.csv", once), settings_);
    return comparison_page(found, 5, R"({"sentence": "A bit was flipped."})");
  }
  [[nodiscard]] std::string drawn(const std::string& html) const {
    return test_support::rendered(folder_.write("page.html", html), folder_.path() / "profile");
  }

  const test::TemporaryFolder folder_;
  ComparisonSettings settings_;
};

TEST_F(ComparisonPage, NeedsNothingFromTheNetwork) {
  const std::string html = page(0.005);

  for (const char* reference : {"src=\"http", "href=\"http", "url(http", "@import", "fetch("})
    EXPECT_EQ(html.find(reference), std::string::npos) << reference;
  EXPECT_EQ(html.find("<script>.csv"), std::string::npos);
}

TEST_F(ComparisonPage, DrawsTheDifferenceOfASingleRowBelowBothCurves) {
  if (!std::filesystem::exists(test_support::kBrowser))
    GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";
  settings_.tolerance = Tolerance{0.001, 0, 0};
  const std::string document = drawn(page(0.005));

  EXPECT_EQ(test_support::body_of(document), "<body data-figures=\"2\">");
  EXPECT_NE(document.find("1 of 2 signals differ"), std::string::npos);
  EXPECT_NE(document.find("outside its tolerance in 1 samples, first at 5.003 s"),
            std::string::npos);
  EXPECT_NE(document.find("other − baseline 0.0000 mm to 5.00 mm"), std::string::npos);
  EXPECT_NE(document.find("A bit was flipped."), std::string::npos);
}

TEST_F(ComparisonPage, SaysThatNothingDiffers) {
  if (!std::filesystem::exists(test_support::kBrowser))
    GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";
  const std::string document = drawn(page(0));

  EXPECT_EQ(test_support::body_of(document), "<body data-figures=\"0\">");
  EXPECT_NE(document.find("Nothing differs"), std::string::npos);
}

}  // namespace
}  // namespace rths::report
