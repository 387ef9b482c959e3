// SPDX-License-Identifier: Apache-2.0
#include <rths/command_line/drawing.hpp>

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace rths::app {
namespace {

Curve circle(int points) {
  Curve curve{"circle", {}, {}};
  for (int i = 0; i <= points; ++i) {
    curve.x.push_back(std::cos(2 * M_PI * i / points));
    curve.y.push_back(std::sin(2 * M_PI * i / points));
  }
  return curve;
}

TEST(Drawing, IsTheSameToTheByteEveryTime) {
  const std::vector<Panel> panels{{"a", "x", "y", {circle(100)}}};

  EXPECT_EQ(draw("title", panels), draw("title", panels));
}

TEST(Drawing, LeavesOutPointsOnAStraightLine) {
  Curve line{"", {}, {}};
  for (int i = 0; i <= 1000; ++i) line.x.push_back(i), line.y.push_back(2.0 * i);

  const auto svg = draw("line", {{"", "x", "y", {line}}});

  EXPECT_NE(svg.find("d=\"M0.0 270.0L360.0 0.0\""), std::string::npos);
}

// A line that returns to its start is still drawn as a line.
TEST(Drawing, KeepsALineThatReturnsToItsStart) {
  Curve line{"", {0, 1, 2, 1, 0}, {5, 5, 5, 5, 5}};

  const auto svg = draw("line", {{"", "x", "y", {line}}});

  EXPECT_NE(svg.find("d=\"M0.0 135.0L360.0 135.0L0.0 135.0\""), std::string::npos) << svg;
}

TEST(Drawing, KeepsTheShapeOfACircle) {
  const auto svg = draw("circle", {{"", "x", "y", {circle(2000)}}});
  const auto path = svg.find("M360.0 135.0L");

  ASSERT_NE(path, std::string::npos);
  // A chord at most 0.15 pixels from its arc is about 2√(2·0.15·r) long; r is 135 to 180.
  const auto lines = std::count(svg.begin() + static_cast<long>(path), svg.end(), 'L');
  EXPECT_GT(lines, 60);
  EXPECT_LT(lines, 400);
}

TEST(Drawing, EscapesMarkup) {
  EXPECT_NE(draw("a < b & c", {}).find("a &lt; b &amp; c"), std::string::npos);
}

TEST(Drawing, RefusesACurveWithUnequalCoordinates) {
  EXPECT_EQ(test::error_of([] {
              static_cast<void>(draw("", {{"p", "", "", {{"", {1}, {}}}}}));
            }),
            "drawing 'p': a curve has 1 x and 0 y, expected equal numbers, at least 1");
}

}  // namespace
}  // namespace rths::app
