// SPDX-License-Identifier: Apache-2.0
//
// Files of ground motion in the formats and spellings that circulate.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/core/constants.hpp>
#include <rths/sim/motion_file.hpp>

#include "support/files.hpp"

namespace rths::sim {
namespace {

constexpr const char* kTitle = "PEER NGA STRONG MOTION DATABASE RECORD\nSOME EVENT 1/1/00, ST 7\n";
constexpr const char* kUnits = "ACCELERATION TIME HISTORY IN UNITS OF G\n";
constexpr const char* kValues = " .1E-01 -.2E-01 .3E-01\n -.4E-01 .5E-01\n -.6E-01 .7E-01 .8E-01\n";

MotionFile read(const std::string& content) { return read_motion_text("motion", content); }

std::string error(const std::string& content) {
  return test::error_of([&] { static_cast<void>(read(content)); });
}

void expect_values(const std::vector<double>& found, const std::vector<double>& expected,
                   const std::string& content) {
  ASSERT_EQ(found.size(), expected.size()) << content;
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-12) << content;
}

const std::vector<double> kEight{0.01, -0.02, 0.03, -0.04, 0.05, -0.06, 0.07, 0.08};

/// Lines of NPTS and DT that state 8 values and .005 s.
std::vector<std::string> headers_of_eight() {
  std::vector<std::string> lines{"NPTS , DT = 8 , .0050",
                                 "NPTS, DT = 8, .0050",
                                 "NPTS,DT=8,.0050",
                                 "NPTS, DT: 8, 0.005",
                                 "DT , NPTS = .0050 , 8",
                                 "NPTS DT 8 .0050",
                                 "npts, dt = 8, 5.0D-03 sec",
                                 "8 0.0050 NPTS, DT",
                                 "8    .0050    NPTS, DT",
                                 "8, .0050, NPTS, DT",
                                 "   8   .0050  npts, dt",
                                 "  .0050 8 DT, NPTS",
                                 "8 NPTS, .0050 DT",
                                 "8 .0050\nNPTS, DT",
                                 "   8    0.00500   \nNPTS, DT",
                                 "NPTS, DT\n8 .0050",
                                 "NPTS= 8\nDT= .0050 SEC",
                                 "DT= .0050 SEC\nNPTS= 8",
                                 "NPTS= 8, DT= 5 MSEC",
                                 "NPTS= 8, DT= 0,005 SEC",
                                 "NPTS= 8, DT= .0050 SEC,   ",
                                 "CH 3: NPTS= 8, DT= .0050 SEC",
                                 "NPTS= 8, DT= .0050 SEC\nFILTER\nNO OTHER\nLINES",
                                 "NPTS = 8 , DT = .0050 SEC HP 0.1 LP 25"};
  for (const char* count : {"NPTS=", "NPTS= ", "NPTS=      ", "NPTS = ", "NPTS ",
                            "NPTS: ", "npts=", "Npts= ", "nPTS =  "})
    for (const char* step : {"DT=   .0050 SEC", "DT=0.005SEC", "dt=  .00500", "DT= 5.0D-03",
                             "DT = 5.d-3 sec", "Dt: .5E-02 s", "DT .0050"}) {
      lines.push_back(fmt::format("{}8, {}", count, step));
      lines.push_back(fmt::format("{} {}8", step, count));
    }
  return lines;
}

TEST(At2Header, IsReadInEverySpelling) {
  const auto headers = headers_of_eight();
  ASSERT_GE(headers.size(), 96U);
  for (const auto& header : headers) {
    const std::string content = kTitle + std::string{kUnits} + header + "\n" + kValues;
    MotionFile motion;
    EXPECT_EQ(test::error_of([&] { motion = read(content); }), "") << header;
    ASSERT_EQ(motion.columns.size(), 1U) << header;
    EXPECT_TRUE(motion.is_at2());
    EXPECT_NEAR(motion.time_step, 0.005, 1e-15) << header;
    expect_values(acceleration_in_g(motion, 1), kEight, header);
  }
}

TEST(At2Header, ThatIsNotUnderstoodIsRefusedWithItsLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"NPTS= 8", "motion:4: DT not found in 'NPTS= 8', expected NPTS and DT"},
      {"NPTS= 8, DT=", "numbers are not assigned"},
      {"NPTS, DT", "numbers are not assigned"},
      {"NPTS= , DT= .0050", "numbers are not assigned"},
      {"NPTS, DT = 2000", "numbers are not assigned"},
      {"NPTS , DT = .0050 , 8", "NPTS is 0.005, expected a whole number"},
      {"NPTS= 8, DT= 2000", "DT is 2000 s, expected a positive time"},
      {"NPTS= 8, DT= 0", "DT is 0 s"},
      {"NPTS= 8, DT= -.005", "DT is -0.005 s"},
      {"NPTS= 8.5, DT= .005", "NPTS is 8.5"},
      {"NPTS= -8, DT= .005", "NPTS is -8"},
      {"NPTS= 1, DT= .005", "NPTS is 1"},
      {"NPTS= 1E30, DT= .005", "NPTS is 1e+30"},
      {"3 NPTS 8 DT .005", "numbers are not assigned"},
      {"NPTS= 8, DT= .005, NPTS= 9", "several NPTS or DT"},
      {"NPTS= 9, DT= .005", "motion:7: 8 values found, expected NPTS = 9"},
      {"NPTS= 7, DT= .005", "motion:7: 8 values found, expected NPTS = 7"},
      {"STEP= .005", "no NPTS in the header, expected NPTS and DT"}};
  for (const auto& [header, message] : cases)
    EXPECT_NE(error(kTitle + std::string{kUnits} + header + "\n" + kValues).find(message),
              std::string::npos)
        << header << ": " << error(kTitle + std::string{kUnits} + header + "\n" + kValues);
}

std::string with_units(const std::string& line, double factor = 1) {
  std::string content = kTitle + line + "\nNPTS= 8, DT= .0050 SEC\n";
  for (const double value : kEight) content += fmt::format("{:.12e}\n", factor * value);
  return content;
}

TEST(At2Units, AreConvertedToG) {
  const std::pair<const char*, double> cases[] = {
      {"ACCELERATION TIME HISTORY IN UNITS OF G", 1},
      {"ACCELERATION TIME SERIES IN UNITS OF G. FILTER POINTS: HP=0.7 Hz LP=0.0 Hz", 1},
      {"Acceleration time history in units of g, filtered", 1},
      {"ACCELERATION TIME HISTORY IN UNITS OF CM/SEC2", 980.665},
      {"ACCELERATION TIME HISTORY IN UNITS OF CM/SEC/SEC", 980.665},
      {"ACCELERATION TIME HISTORY IN UNITS OF CM/SEC**2. FILTERED", 980.665},
      {"ACCELERATION TIME HISTORY IN UNITS OF CM / S2", 980.665},
      {"ACCELERATION TIME HISTORY IN UNITS OF cm/s², corrected", 980.665},
      {"ACCELERATION TIME HISTORY IN UNITS OF GAL", 980.665},
      {"ACCELERATION TIME HISTORY, UNITS: gal", 980.665},
      {"ACCELERATION TIME HISTORY (CM/S/S)", 980.665},
      {"ACCELERATION TIME HISTORY IN CM/S^2", 980.665},
      {"ACCELERATION TIME HISTORY IN UNITS OF M/SEC2", kStandardGravity},
      {"ACCELERATION TIME HISTORY IN UNITS  OF  M/S/S", kStandardGravity},
      {"ACCELERATION TIME HISTORY IN UNITS OF MM/S2", 1000 * kStandardGravity},
      {"ACCELERATION IN CM/SEC2", 980.665},
      {"ACCELERATION (CORRECTED), RECORDED IN A TOWN", 1},
      {"NO UNIT", 1}};
  for (const auto& [line, factor] : cases)
    expect_values(acceleration_in_g(read(with_units(line, factor)), 1), kEight, line);
}

TEST(At2Units, OfOtherQuantitiesOrUnknownAreRefusedByName) {
  const std::pair<const char*, const char*> cases[] = {
      {"VELOCITY TIME HISTORY IN UNITS OF CM/S", "a record of velocity, expected acceleration"},
      {"DISPLACEMENT TIME HISTORY IN UNITS OF CM", "a record of displacement, expected accel"},
      {"VELOCITY (CM/S)", "a record of velocity, expected acceleration"},
      {"TIME HISTORY IN UNITS OF CM/SEC", "the unit is cm/s, expected one of acceleration"},
      {"ACCELERATION TIME HISTORY IN UNITS OF G/7", "the unit 'G/7' is unknown"},
      {"ACCELERATION TIME HISTORY IN UNITS OF G / 7", "the unit 'G / 7' is unknown"},
      {"ACCELERATION TIME HISTORY IN UNITS OF G*10", "the unit 'G*10' is unknown"},
      {"ACCELERATION TIME HISTORY IN UNITS OF TENTHS OF G", "the unit 'TENTHS OF G' is unknown"},
      {"ACCELERATION TIME HISTORY IN UNITS OF COUNTS",
       "the unit is counts, expected one of accel"}};
  for (const auto& [line, message] : cases)
    EXPECT_NE(error(with_units(line)).find(std::string{"motion:3: "}), std::string::npos)
        << error(with_units(line));
  for (const auto& [line, message] : cases)
    EXPECT_NE(error(with_units(line)).find(message), std::string::npos) << error(with_units(line));
  for (const char* title : {"ACC (MPS2)", "IN METERS PER SECOND PER SECOND", "A OF T <M/S2>"})
    EXPECT_FALSE(
        error(fmt::format("{}{}\nNPTS= 8, DT= .0050 SEC\n{}", kTitle, title, kValues)).empty())
        << title;
}

TEST(At2Values, MayTouchAndEndLinesInAnyWay) {
  const std::string header = kTitle + std::string{kUnits} + "NPTS= 8, DT= .0050 SEC\n";
  const std::string touching =
      "1.00E-02-2.00E-02 3.00E-02-4.00E-02 5.00E-02\n-6.00E-02 7.00E-02 8.00E-02";
  const std::string fortran = "1.D-2 -2.D-02 3.d-02 -4.D-02 5.D-02 -6.D-02 +7.D-02 .8D-01\n";
  for (const auto& values : {touching, fortran, "\n" + fortran + "\n\n", fortran + "\x1A"}) {
    const std::string content = header + values;
    for (const char* end : {"\n", "\r\n", "\r"}) {
      std::string other;
      for (const char c : "\xEF\xBB\xBF" + content) other += c == '\n' ? end : std::string{c};
      expect_values(acceleration_in_g(read(other), 1), kEight, other);
    }
  }
}

TEST(At2Values, ThatAreNoNumbersAreRefused) {
  const std::string header = kTitle + std::string{kUnits} + "NPTS= 3, DT= .0050 SEC\n";
  for (const char* wrong : {"*******", "NaN", "inf", "1.2.3", "1E", "0x1p3", "1e999", "3abc"})
    EXPECT_NE(error(header + "0.1 " + wrong + " 0.2\n").find(":5: '" + std::string{wrong} + "'"),
              std::string::npos)
        << error(header + "0.1 " + wrong + " 0.2\n");
}

TEST(MotionFile, ContentDecidesOnTheFormatAndNotTheName) {
  const test::TemporaryFolder folder;
  const auto at2 = folder.write("a.csv", with_units(kUnits));
  const auto columns = folder.write("b.AT2", "t,a\n0,.1\n.01,.2\n");

  EXPECT_TRUE(read_motion_file(at2).is_at2());
  EXPECT_FALSE(read_motion_file(columns).is_at2());
}

TEST(MotionFile, ColumnsMayKeepTheHeaderOfAnAt2File) {
  const auto motion = read("NPTS= 3, DT= .01 SEC\ntime,ns\n0,.1\n.01,.2\n.02,.3\n");

  EXPECT_EQ(motion.format, "columns");
  expect_values(acceleration_in_g(motion, 1), {0.1, 0.2, 0.3}, "");
}

TEST(MotionFile, ThatIsARecordIsNoFileOfColumns) {
  EXPECT_NE(test::error_of([] {
              const test::TemporaryFolder folder;
              static_cast<void>(read_column(folder.write("a.AT2", with_units(kUnits)), 1));
            }).find("found a record of ground acceleration (.AT2)"),
            std::string::npos);
}

/// Four counts around an offset of 1000, peak 300, of 0.5 gal each.
std::string k_net(const std::string& scale = "1000(gal)/2000", const std::string& duration = "4",
                  const std::string& peak = "150.0") {
  return "Origin Time       2000/01/01 00:00:00\nLat.              38.1\n"
         "Sampling Freq(Hz) 1Hz\nDuration Time(s)  " +
         duration + "\nDir.              N-S\nScale Factor      " + scale + "\nMax. Acc. (gal)   " +
         peak + "\nMemo.\n    1300     1000      700\n    1000\n";
}

TEST(KNetFile, IsReadWithItsScaleFactorAndWithoutItsOffset) {
  const auto motion = read(k_net());

  EXPECT_EQ(motion.format, "K-NET");
  EXPECT_EQ(motion.time_step, 1);
  EXPECT_EQ(motion.columns[0].heading, "N-S");
  expect_values(acceleration_in_g(motion, 1), {150 / 980.665, 0, -150 / 980.665, 0}, "");
}

TEST(KNetFile, ThatContradictsItsHeaderIsRefused) {
  EXPECT_NE(error(k_net("3920/6182761")).find(":6: 'Scale Factor      3920/6182761', expected"),
            std::string::npos);
  EXPECT_NE(error(k_net("1000(gal)/2000", "5")).find("4 values found, expected 5 (Duration Time)"),
            std::string::npos);
  EXPECT_NE(error(k_net("1000(gal)/2000", "4", "75")).find(":7: the peak is 150 gal, expected 75"),
            std::string::npos);
}

std::string esm(const std::string& type = "ACCELERATION", const std::string& unit = "cm/s^2",
                const std::string& count = "3") {
  return "EVENT_NAME: AN_EVENT\nSAMPLING_INTERVAL_S: 0.005000\nNDATA: " + count +
         "\nSTREAM: HNE\nUNITS: " + unit + "\nDATA_TYPE: " + type +
         "\nUSER1: 7\n98.0665\n-196.133\n0\n";
}

TEST(EsmFile, IsReadInItsUnit) {
  const auto motion = read(esm());

  EXPECT_EQ(motion.format, "ESM");
  EXPECT_EQ(motion.time_step, 0.005);
  EXPECT_EQ(motion.columns[0].heading, "HNE");
  expect_values(acceleration_in_g(motion, 1), {0.1, -0.2, 0}, "");
}

TEST(EsmFile, ThatContradictsItsHeaderIsRefused) {
  EXPECT_NE(error(esm("VELOCITY", "cm/s")).find(":6: a record of VELOCITY, expected ACCELERATION"),
            std::string::npos);
  EXPECT_NE(error(esm("ACCELERATION", "cm/s")).find(":5: the unit is 'cm/s', expected cm/s^2"),
            std::string::npos);
  EXPECT_NE(error(esm("ACCELERATION", "cm/s^2", "4")).find("3 values found, expected 4 (NDATA)"),
            std::string::npos);
}

/// Two columns of 0.1, 0.2, 0.3 g times `factor` below a heading.
std::string table(const std::string& heading, double factor = 1, const std::string& gap = ",") {
  std::string content = heading + "\n";
  for (int i = 0; i < 3; ++i)
    content += fmt::format("{:.3f}{}{:.15g}{}{:.15g}\n", 0.01 * i, gap, 0.1 * factor * (i + 1), gap,
                           0.05 * factor);
  return content;
}

TEST(ColumnUnits, OfTheHeadingAreConvertedToG) {
  const std::pair<const char*, double> cases[] = {{"[g]", 1},
                                                  {"(g)", 1},
                                                  {"[G]", 1},
                                                  {"[gal]", 980.665},
                                                  {"[Gal]", 980.665},
                                                  {"(cm/s2)", 980.665},
                                                  {"[cm/s^2]", 980.665},
                                                  {"[cm/s²]", 980.665},
                                                  {"[cm/s\xB2]", 980.665},
                                                  {"[cm s-2]", 980.665},
                                                  {"[cm·s⁻²]", 980.665},
                                                  {"(cm/sec/sec)", 980.665},
                                                  {"[m/s2]", kStandardGravity},
                                                  {"[m/s²]", kStandardGravity},
                                                  {"(m/s**2)", kStandardGravity},
                                                  {"[%g]", 100},
                                                  {"[% of g]", 100},
                                                  {"[mm/s2]", 1000 * kStandardGravity},
                                                  {"[mg]", 1000},
                                                  {"[ft/s2]", kStandardGravity / 0.3048}};
  for (const auto& [unit, factor] : cases)
    for (const char* gap : {",", ";", "\t"})
      expect_values(
          acceleration_in_g(
              read(table(fmt::format("time [s]{0}ns {1}{0}ew {1}", gap, unit), factor, gap)), 1),
          {0.1, 0.2, 0.3}, unit);
  for (const char* heading : {"# t ns [gal] ew [gal]", "t ns_gal ew_gal", "acceleration in gal"})
    expect_values(acceleration_in_g(read(table(heading, 980.665, " ")), 1), {0.1, 0.2, 0.3},
                  heading);
  const std::pair<const char*, double> suffixes[] = {
      {"t_s,h1_m/s2,h2_m/s2", kStandardGravity},
      {"t_s,h1_g,h2_g", 1},
      {"t,ns_gal,ew_gal", 980.665},
      {"t,h1_m_s2,h2_m_s2", kStandardGravity},
      {"t,acc_cms2,acc2_cms2", 980.665},
      {"t,ns_cm_per_s2,ew_cm_per_s2", 980.665},
      {"t,ns (in gal),ew (units: gal)", 980.665},
      {"t,ns [m.s-2],ew [m.s-2]", kStandardGravity},
      {"t,cm/s2,cm/s2", 980.665},
      {"t,ns,ew\ns,gal,gal", 980.665},
      {"t,ns,ew\n[s],[m/s2],[m/s2]", kStandardGravity},
      {"Units: cm/s2\nt,ns,ew", 980.665},
      {"acceleration in m/s²\nt,ns,ew", kStandardGravity},
      {"# t,ns [gal],ew [gal]", 980.665},
      {"t,ns,ew", 1},
      {"Station 12 g3\n", 1}};
  for (const auto& [heading, factor] : suffixes)
    expect_values(acceleration_in_g(read(table(heading, factor)), 1), {0.1, 0.2, 0.3}, heading);
}

TEST(ColumnUnits, OfOtherQuantitiesOrUnknownAreRefusedByName) {
  for (const char* unit : {"m/s", "cm/s", "mm/s", "m", "cm", "mm", "deg", "V", "counts"})
    EXPECT_NE(test::error_of([&] {
                static_cast<void>(acceleration_in_g(
                    read(table(fmt::format("t [s],ns [{0}],ew [{0}]", unit))), 1));
              }).find(fmt::format("the column 'ns [{}]' is no acceleration", unit)),
              std::string::npos)
        << unit;
  for (const char* heading : {"t_s,h1_m/s,h2_m/s", "t,vel_ns,vel_ew", "t,displacement,b",
                              "t,h1_m_s,h2_m_s", "Velocity of a station\nt,ns,ew", "t,x_m,y_m"})
    EXPECT_NE(test::error_of([&] {
                static_cast<void>(acceleration_in_g(read(table(heading)), 1));
              }).find("is no acceleration"),
              std::string::npos)
        << heading;
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(acceleration_in_g(read(table("Max. acc. 345 gal\nt,ns,ew")), 1));
            }).find("the unit 'max. acc. 345 gal'"),
            std::string::npos);
  EXPECT_NE(
      test::error_of([&] {
        static_cast<void>(acceleration_in_g(read(table("t [s],ns (milli g),ew (milli g)")), 1));
      }).find("the unit 'milli g' of the column 'ns (milli g)' is unknown"),
      std::string::npos);
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(acceleration_in_g(read(table("t [s],ns [g/7],ew [g/7]")), 1));
            }).find("the unit 'g/7' of the column 'ns [g/7]' is unknown"),
            std::string::npos);
}

// Weak motions in m/s² are as large as strong ones in g, so no later check finds them.
TEST(ColumnUnits, AtPlacesThatAreNotUnderstoodAreNotReadAsG) {
  for (const char* heading :
       {"# m/s2\nt,ns,ew", "Einheit: m/s2\nt,ns,ew", "t,ns,ew\n# a in m/s2", "t,a/ms-2,b/ms-2",
        "# gal\nt,ns,ew", "t,ns [m/s2, raw],ew", "\"t, s\",\"ns, m/s2\",\"ew, m/s2\"",
        "t,a_mps2,b_mps2", "t,NS-m/s2,EW-m/s2", "t,ns_m_s-2,ew_m_s-2",
        "in metres per second squared\nt,ns,ew", "ug in m per s per s\nt,ns,ew", "t,ns [gal],ew"})
    EXPECT_NE(test::error_of([&] {
                static_cast<void>(acceleration_in_g(read(table(heading)), 2));
              }).find("is unknown, expected g, m/s²"),
              std::string::npos)
        << heading;
  for (const char* heading : {"Vs30 760 m/s, 2001\nt,ns,ew", "760 m/s 2001\nt,ns,ew"})
    expect_values(acceleration_in_g(read(table(heading)), 1), {0.1, 0.2, 0.3}, heading);
  expect_values(acceleration_in_g(read(table("t,ns {m/s2},$m/s^{2}$", kStandardGravity)), 1),
                {0.1, 0.2, 0.3}, "braces");
}

TEST(ColumnFile, IsReadWithAnyLineEndsAndHeadings) {
  const std::string plain = table("time [s],ns [g],ew [g]");
  std::string carriage = plain;
  std::replace(carriage.begin(), carriage.end(), '\n', '\r');
  for (const auto& content :
       {plain, "\xEF\xBB\xBF" + plain, carriage, plain.substr(0, plain.size() - 1),
        "Station 12, 3 channels\n2 horizontal components\n" + plain, "7\n" + plain,
        "# 2000 samples\n" + plain + "# end\n", "\n\n" + plain}) {
    const auto motion = read(content);
    EXPECT_NEAR(motion.time_step, 0.01, 1e-12) << content;
    EXPECT_EQ(motion.columns.at(1).heading, "ew [g]") << content;
    expect_values(acceleration_in_g(motion, 1), {0.1, 0.2, 0.3}, content);
  }
}

TEST(ColumnFile, HasDecimalCommasWhereNothingElseSeparatesWithThem) {
  for (const char* gap : {";", "\t", " ", " ; "}) {
    std::string content = table("time\tns\tew", 1, gap);
    std::replace(content.begin(), content.end(), '.', ',');
    expect_values(acceleration_in_g(read(content), 1), {0.1, 0.2, 0.3}, content);
  }
  expect_values(acceleration_in_g(read("t,a\n\"0,00\",\"0,1\"\n\"0,01\",\"0,2\"\n"), 1), {0.1, 0.2},
                "");
  std::string commas = table("time,ns,ew");
  std::replace(commas.begin(), commas.end(), '.', ',');
  EXPECT_NE(error(commas).find("looks like numbers with decimal commas"), std::string::npos)
      << error(commas);
  for (const char* ambiguous : {"t;a\n1,000;2,500\n1,005;2,600\n", "t\ta\n0,1\t1.5\n0,2\t1.6\n"})
    EXPECT_NE(error(ambiguous).find("looks like a number with a decimal comma"), std::string::npos)
        << error(ambiguous);
}

TEST(ColumnFile, HasATimeInMillisecondsIfItsHeadingSaysSo) {
  for (const char* heading : {"t [ms]", "time_ms", "Time (ms)", "time [msec]", "t/ms",
                              "time (milliseconds)", "time (in ms)"})
    EXPECT_NEAR(read(fmt::format("{},a,b\n0,1,1\n5,1,1\n10,1,1\n", heading)).time_step, 0.005,
                1e-12)
        << heading;
  EXPECT_NEAR(read("t [sec.],a\n0,1\n.005,1\n").time_step, 0.005, 1e-12);
  for (const char* unit : {"[min]", "(minutes)", "(hours)", "[0.1 s]", "(10 ms)", "(10ms)"})
    EXPECT_NE(error(fmt::format("t {},a,b\n0,1,1\n.05,1,1\n", unit)).find("of the time"),
              std::string::npos)
        << unit;
}

TEST(ColumnFile, OfValuesAloneStatesNoStep) {
  for (const char* heading : {"", "0.5 s apart\n", "NS acceleration of a station [gal]\n"}) {
    const auto motion = read(std::string{heading} + "98.0665\n196.133\n294.1995\n");
    EXPECT_EQ(motion.time_step, 0) << heading;
    EXPECT_TRUE(motion.has_one_component());
    const double factor = std::string{heading}.find("gal") == std::string::npos ? 980.665 : 1;
    expect_values(acceleration_in_g(motion, 1), {0.1 * factor, 0.2 * factor, 0.3 * factor},
                  heading);
  }
}

TEST(ColumnFile, WithADamagedRowIsRefusedWithItsLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"t,a,b\n0,1,1\n.01,1\n.02,1,1\n", ":3: 2 columns found, expected 3 as in the first row"},
      {"t,a,b\n0,1,1\n.01,,1\n.02,1,1\n", ":3: an empty cell"},
      {"t,a,b\n0,1x,1\n.01,1,1\n.02,1,1\n", ":2: '1x' is not a number"},
      {"t,a,b\n0,1,1\nx,1,1\n.02,1,1\n", ":3: 'x"},
      {"t,a,b\n0,1,1\n.01,nan,1\n.02,1,1\n", ":3: 'nan' is not a number"},
      {"t,a,b\n0,1,1\n.01,1,1\nEND\n", ":4: 'END' is not a number"},
      {"2024-05-13\n2024-05-14\n", "no row of numbers"},
      {"nothing\n", "no row of numbers"},
      {"", "no row of numbers"}};
  for (const auto& [content, message] : cases)
    EXPECT_NE(error(content).find(message), std::string::npos) << content << error(content);
}

// Any file is read or refused; a reader that crashes or hangs fails the test.
TEST(MotionFile, OfRandomBytesOrCutAnywhereIsReadOrRefused) {
  std::mt19937 random{1};
  const std::string at2 = with_units(kUnits), columns = table("time [s],ns [gal],ew [gal]"),
                    others[] = {at2, columns, k_net(), esm()};
  const std::string alphabet = "0123456789.,;+-eED \t\r\n\"[]()/#%NPTSDT=\xEF\xBB\xBF\x00\xB2gal";
  for (int trial = 0; trial < 5000; ++trial) {
    std::string content = others[trial % 4];
    const auto any = [&](std::size_t most) { return random() % most; };
    if (trial % 3 == 0) content.resize(any(content.size()));
    for (std::size_t i = any(12); i > 0 && !content.empty(); --i)
      content[any(content.size())] =
          trial % 5 == 0 ? static_cast<char>(random()) : alphabet[any(alphabet.size())];
    static_cast<void>(looks_like_motion(content));
    static_cast<void>(test::error_of([&] {
      const auto motion = read(content);
      for (std::size_t i = 0; i < motion.columns.size(); ++i)
        for (const double value : acceleration_in_g(motion, static_cast<int>(i) + 1))
          ASSERT_TRUE(std::isfinite(value)) << content;
    }));
  }
}

}  // namespace
}  // namespace rths::sim
