// SPDX-License-Identifier: Apache-2.0
//
// Headers like that of an .AT2 file, in all combinations of their usual parts.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/core/constants.hpp>
#include <rths/sim/motion_file.hpp>

#include "support/files.hpp"

namespace rths::sim::spellings {
namespace {

constexpr double kTimeStep = 0.005;                                                    // [s]
const std::vector<double> kRecord{0.01, -0.02, 0.03, -0.04, 0.05, -0.06, 0.07, 0.08};  // [g]

/// A header, with `{points}` and `{unit}` for the lines of NPTS and of the unit.
const std::vector<std::string> kLayouts{
    "PEER NGA STRONG MOTION DATABASE RECORD\nSOME EVENT 1/1/00, ST 7\n{unit}\n{points}\n",
    "PACIFIC ENGINEERING AND ANALYSIS STRONG-MOTION DATA\nEVENT\n{unit}\nHP .1 HZ\n{points}\n",
    "PEER STRONG MOTION RECORD\nEVENT, 1979\nSTATION 7\n{unit}\n{points}\nFILTER\n2 POLES\n",
    "{points}\n{unit}\nA RECORD OF 1940\n", "\n\n{unit}\n\n{points}\n\n"};

/// 8 values at .005 s.
const std::vector<std::string> kPoints{"NPTS=  8, DT= .00500 SEC", "NPTS= 8 DT= .0050 SEC,",
                                       "DT= .005 , NPTS= 8",       "NPTS = 8 , DT = 0.005",
                                       "npts=8,dt=5.0e-3",         "NPTS, DT = 8 , .0050",
                                       "8   .0050  NPTS, DT",      "   8    0.00500 NPTS, DT (SEC)",
                                       "NPTS: 8  DT: 0.005 s",     "NPTS= 8, DT= 5.D-03",
                                       "NPTS=8, DT(SEC)=0.005",    "NPTS= 8, DT (MSEC) = 5",
                                       "DT=0,005 SEC NPTS=8",      "NPTS 8 DT .005",
                                       "# NPTS= 8, DT= .005 SEC"};

struct UnitLine {
  std::string text;
  double per_g;
};
const std::vector<UnitLine> kUnits{
    {"ACCELERATION TIME HISTORY IN UNITS OF G", 1},
    {"ACCELERATION TIME SERIES IN UNITS OF CM/SEC/SEC", 100 * kStandardGravity},
    {"ACCELERATION TIME HISTORY IN UNITS OF GAL, FILTERED", 100 * kStandardGravity},
    {"Acceleration (m/s^2)", kStandardGravity},
    {"ACC. [%g]", 100},
    {"CORRECTED RECORD, CM/S2", 100 * kStandardGravity},
    {"A RECORD", 1}};

/// Ways to write the values; `width` per line.
std::string written(const std::vector<double>& values, const std::string& style) {
  std::string text;
  const std::size_t width = style == "one line" ? 99 : style == "one each" ? 1 : 5;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::string number = fmt::format("{:.9E}", values[i]);
    const auto replace = [&](const std::string& from, const std::string& to) {
      number.replace(number.find(from), from.size(), to);
    };
    if (style == "D") replace("E", "D");
    if (style == "no letter") replace("E", "");
    if (style == "decimal commas") replace(".", ",");
    const std::string gap = style == "touching" && values[i] < 0 ? "" : "  ";
    text += gap + number + (style == "commas" ? "," : "");
    if ((i + 1) % width == 0 || i + 1 == values.size()) text += "\n";
  }
  return text;
}

std::string filled(std::string layout, const std::string& unit, const std::string& points) {
  for (const auto& [name, text] : {std::pair{"{unit}", unit}, std::pair{"{points}", points}})
    layout.replace(layout.find(name), std::string{name}.size(), text);
  return layout;
}

std::string with_ends(const std::string& text, const std::string& end) {
  std::string result;
  for (const char c : text) result += c == '\n' ? end : std::string{c};
  return result;
}

void expect_record(const std::string& content) {
  MotionFile motion;
  ASSERT_EQ(test::error_of([&] { motion = read_motion_text("motion", content); }), "") << content;
  EXPECT_NEAR(motion.time_step, kTimeStep, 1e-15) << content;
  ASSERT_EQ(motion.columns.size(), 1U) << content;
  const auto found = acceleration_in_g(motion, 1);
  ASSERT_EQ(found.size(), kRecord.size()) << content;
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], kRecord[i], 1e-9) << content;
}

std::vector<double> times(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

TEST(At2Spellings, AreReadInEveryCombination) {
  std::size_t count = 0;
  for (const auto& layout : kLayouts)
    for (const auto& points : kPoints)
      for (const auto& unit : kUnits)
        for (const char* style : {"E", "D", "no letter", "touching", "commas", "one each",
                                  "one line", "decimal commas"}) {
          const std::string content =
              filled(layout, unit.text, points) + written(times(kRecord, unit.per_g), style);
          ASSERT_NO_FATAL_FAILURE(expect_record(content));
          ++count;
        }
  EXPECT_GE(count, 96U);
}

TEST(At2Spellings, AreReadWithAnyLineEndsAndMarks) {
  for (const auto& layout : kLayouts)
    for (const auto& points : kPoints) {
      const std::string content =
          filled(layout, kUnits[1].text, points) + written(times(kRecord, kUnits[1].per_g), "E");
      for (const char* end : {"\n", "\r\n", "\r"}) {
        const std::string text = with_ends(content, end);
        expect_record("\xEF\xBB\xBF" + text);
        expect_record(text.substr(0, text.size() - std::string{end}.size()));
        expect_record(text + "\x1A");
      }
    }
}

/// A part of a header that is wrong, and a word of the message.
struct Wrong {
  std::string points, unit, message;
};
const std::vector<Wrong> kWrong{
    {"NPTS= 9, DT= .005 SEC", kUnits[0].text, "8 values found, expected NPTS = 9"},
    {"NPTS= 7, DT= .005 SEC", kUnits[0].text, "8 values found, expected NPTS = 7"},
    {"NPTS= 8", kUnits[0].text, "DT not found"},
    {"NPTS= 8, DT= SEC", kUnits[0].text, "numbers are not assigned"},
    {"NPTS= 8, DT= 200 SEC", kUnits[0].text, "DT is 200 s"},
    {"NPTS= 8, DT= .005, DT= .01", kUnits[0].text, "several NPTS or DT"},
    {"8.5 .005 NPTS, DT", kUnits[0].text, "NPTS is 8.5"},
    {kPoints[0], "VELOCITY TIME HISTORY IN UNITS OF CM/SEC", "a record of velocity"},
    {kPoints[0], "DISPLACEMENT TIME SERIES IN UNITS OF CM", "a record of displacement"},
    {kPoints[0], "VEL. TIME HISTORY", "a record of velocity"},
    {kPoints[0], "CORRECTED VELOCITY (CM/S)", "a record of velocity"},
    {kPoints[0], "DISP (CM)", "a record of displacement"},
    {kPoints[0], "TIME HISTORY IN UNITS OF M/S", "the unit is m/s"},
    {kPoints[0], "ACCELERATION TIME HISTORY IN UNITS OF VOLT", "the unit 'VOLT' is unknown"},
    {kPoints[0], "ACCELERATION TIME HISTORY IN UNITS OF G*10", "the unit 'G*10' is unknown"},
    {kPoints[0], "MAX. 206 GAL", "states the unit of the peak"}};

TEST(At2Spellings, ThatAreWrongAreRefusedInEveryLayout) {
  for (const auto& layout : kLayouts)
    for (const auto& wrong : kWrong) {
      const std::string content = filled(layout, wrong.unit, wrong.points) + written(kRecord, "E");
      const auto message =
          test::error_of([&] { static_cast<void>(read_motion_text("motion", content)); });
      EXPECT_NE(message.find(wrong.message), std::string::npos) << content << message;
      EXPECT_TRUE(message.starts_with("motion:")) << message;
    }
}

TEST(At2Spellings, WithADamagedValueAreRefused) {
  const std::string header = filled(kLayouts[0], kUnits[0].text, kPoints[0]);
  for (const char* wrong : {"NaN", "Inf", "*****", "1.2.3", "0,1,2", "--1", "1E+"}) {
    std::string values = written(kRecord, "E");
    values.replace(values.find("3.000000000E-02"), 15, wrong);
    EXPECT_NE(
        test::error_of([&] { static_cast<void>(read_motion_text("motion", header + values)); }), "")
        << wrong;
  }
}

// The name counts only where the header does not state the quantity.
TEST(At2Spellings, OfAFileOfVelocityByNameNeedATitle) {
  const std::string values = written(kRecord, "E");
  const auto error = [&](const char* name, const std::string& unit) {
    return test::error_of([&] {
      static_cast<void>(read_motion_text(name, filled(kLayouts[0], unit, kPoints[0]) + values));
    });
  };
  EXPECT_NE(error("a.VT2", "A RECORD").find("record of velocity, expected"), std::string::npos);
  EXPECT_NE(error("a.dt2", "A RECORD").find("record of displacement, expected"), std::string::npos);
  EXPECT_EQ(error("a.VT2", kUnits[0].text), "");
}

TEST(At2Spellings, OfColumnsMustHaveTheStepOfTheirTime) {
  const std::string rows = "0 .1\n.005 .2\n.010 .3\n";

  EXPECT_EQ(read_motion_text("m", "NPTS= 3, DT= .005\n" + rows).format, "columns");
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(read_motion_text("m", "NPTS= 3, DT= .01\n" + rows));
            }).find("DT is 0.01 s, but the first column has steps of 0.005 s"),
            std::string::npos);
}

}  // namespace
}  // namespace rths::sim::spellings
