// SPDX-License-Identifier: Apache-2.0
//
// Records in the formats of strong-motion networks, made here after their public descriptions.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/core/constants.hpp>
#include <rths/sim/motion_file.hpp>

#include "support/files.hpp"

namespace rths::sim::records {
namespace {

using Values = std::vector<double>;

constexpr double kGal = 100 * kStandardGravity;  // per g

MotionFile read_record(const std::string& content) { return read_motion_text("record", content); }

std::string error_of_record(const std::string& content) {
  return test::error_of([&] { static_cast<void>(read_record(content)); });
}

void expect_found(const std::string& content, const std::string& message) {
  EXPECT_NE(error_of_record(content).find(message), std::string::npos) << error_of_record(content);
}

void expect_near(const Values& found, const Values& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9) << i;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Rows of `per_line` values in columns of `width` characters, as Fortran writes them.
std::string rows(const Values& values, std::size_t per_line, int width, int decimals) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i)
    text += fmt::format("{:{}.{}f}{}", values[i], width, decimals,
                        (i + 1) % per_line == 0 || i + 1 == values.size() ? "\n" : "");
  return text;
}

std::string lines(std::size_t count, const std::string& line) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += line + "\n";
  return text;
}

/// 7 lines of 100 integers and 7 of 50 reals, of which some touch.
std::string header_numbers() {
  return lines(6,
               "    1  100    1    3    3  200    1    3 -999   24   12 250013200146    1    0") +
         "    0    0    0    0\n" +
         lines(6,
               "  .0108814  .6700000 66.000000-999.00000      .000 629.00000  .0791795 30.590000") +
         " 7.9000000 9.2000000\n";
}

/// A corrected channel of CSMIP: acceleration, velocity and displacement.
std::string csmip_v2(int channel, const std::string& direction, const Values& gal) {
  const auto block = [&](const char* quantity, const char* unit, const Values& values) {
    return fmt::format(" {:5} points of {} data equally spaced at  .020 sec, in {}. (8f10.6)\n",
                       values.size(), quantity, unit) +
           rows(values, 8, 10, 6);
  };
  return fmt::format("Corrected accelerogram   12345-S1       Chan {:2}: {}     from\n", channel,
                     direction) +
         "Uncorrected Accelerogram Data             Processed: 01/01/00\n" +
         fmt::format("Chan {:2}: {}\n", channel, direction) +
         fmt::format(
             "  {} points of instrument- and baseline-corrected accel, veloc and displ data\n",
             gal.size()) +
         "Peak acceleration =    77.280    cm/sec/sec  at   30.585   sec.\n" + header_numbers() +
         block("accel", "cm/sec2", gal) + block("veloc", "cm/sec", Values(gal.size(), 1)) +
         block("displ", "cm", Values(gal.size(), 2)) +
         fmt::format("/&  ----------  End of data for channel {:2}  ----------\n", channel);
}

// The second and third value touch, without a sign between them.
const Values kGals{-1.5, 100.25, 200.125, -30.5, 0, 1, 2, 3, 4.5};

Values in_g(Values values, double per_g = kGal) {
  for (double& value : values) value /= per_g;
  return values;
}

TEST(CsmipRecord, OfVolumeTwoIsReadByChannel) {
  const auto motion = read_record(csmip_v2(1, "360 Deg", kGals) + csmip_v2(2, " Up", {1, 2, 3}) +
                                  csmip_v2(3, " 90 Deg", kGals));

  EXPECT_EQ(motion.format, "CSMIP");
  EXPECT_NEAR(motion.time_step, 0.02, 1e-12);
  EXPECT_TRUE(motion.has_channels);
  ASSERT_EQ(motion.columns.size(), 3U);
  EXPECT_EQ(motion.columns[0].heading, "Chan 1: 360 Deg");
  EXPECT_EQ(motion.columns[1].heading, "Chan 2: Up");
  expect_near(acceleration_in_g(motion, 1), in_g(kGals));
  expect_near(acceleration_in_g(motion, 2), in_g({1, 2, 3}));
}

TEST(CsmipRecord, OfVolumeTwoIsReadInOlderSpellings) {
  const std::string upper =
      "CORRECTED ACCELEROGRAM   36456      CHAN  1:  90 DEG     FROM\n"
      "UNCORRECTED ACCELEROGRAM DATA     PROCESSED:  6/06/83\nCHAN  1:  90 DEG\n" +
      header_numbers() +
      "    3 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)\n"
      "    -3.038     -.787     2.288\n";
  expect_near(acceleration_in_g(read_record(upper), 1), in_g({-3.038, -0.787, 2.288}));
  EXPECT_TRUE(read_record(upper).has_one_component());
  // Of the University of Southern California: the unit is that of the peak.
  const std::string usc =
      "CORRECTED ACCELEROGRAM  IIBA338  COMP S58W\n"
      "FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:\nCOMP S58W\n"
      "PEAK ACCELERATION =    -6.86900  CMS/SEC/SEC AT     .640   SEC.\n"
      "    3 POINTS OF ACC DATA EQUALLY SPACED AT   .020 SEC.\n"
      "  -.300   .700  6.869\n";
  expect_near(acceleration_in_g(read_record(usc), 1), in_g({-0.3, 0.7, 6.869}));
}

std::string csmip_v1(const std::string& unit) {
  return "Uncorrected Accelerogram Data             Processed: 02/13/12, CGS\n" + lines(5, "text") +
         "Chan  1:  90 Deg\n" +
         "Units of uncor data are sec and g .        Max  =   .079 g , at  30.590 sec.\n" +
         lines(5, "text") + header_numbers() +
         "     9 Accelerogram points at 200 pts/sec in units of " + unit + "  Format: (8f9.6)\n" +
         rows({0.01, -0.02, 0.03, 0, 0, 0, 0, 0, -0.5}, 8, 9, 6) +
         "/&  ----------  End of Data for Channel  1  ----------\n";
}

TEST(CsmipRecord, OfVolumeOneIsReadInItsUnit) {
  for (const auto& [unit, per_g] : {std::pair{"g .", 1.0}, std::pair{"g.", 1.0},
                                    std::pair{"g/10.", 10.0}, std::pair{"cm/sec2.", kGal}}) {
    const auto motion = read_record(csmip_v1(unit));
    EXPECT_NEAR(motion.time_step, 0.005, 1e-12);
    expect_near(acceleration_in_g(motion, 1),
                in_g({0.01, -0.02, 0.03, 0, 0, 0, 0, 0, -0.5}, per_g));
  }
}

/// Pairs of time and tenths of g, with `shift` s added to the last time.
std::string csmip_pairs(double shift = 0) {
  Values pairs;
  for (int i = 0; i < 12; ++i) {
    pairs.push_back(0.005 * i + (i == 11 ? shift : 0));
    pairs.push_back(0.1 * i);
  }
  return "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 07/16/98, CDMG 13160\n" +
         lines(5, "TEXT") + "CHAN  1:  90 DEG\n" + lines(3, "TEXT") +
         "NO. OF POINTS =     12  RECORD LENGTH =   .055 SEC\n"
         "UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  =  -.055 G, AT  15.992 SEC.\n"
         "RMS ACCEL OF COMPLETE RECORD =  .006 G.\n" +
         header_numbers() + rows(pairs, 10, 7, 3) +
         "/&  ----------  END OF DATA FOR CHANNEL  1  ----------\n";
}

TEST(CsmipRecord, OfPairsIsReadIfItsTimesAreEquallySpaced) {
  const auto motion = read_record(csmip_pairs() + csmip_pairs());

  EXPECT_NEAR(motion.time_step, 0.005, 1e-12);
  ASSERT_EQ(motion.columns.size(), 2U);
  EXPECT_EQ(motion.columns[1].heading, "CHAN 1: 90 DEG");
  expect_near(acceleration_in_g(motion, 1),
              {0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1, 0.11});
  expect_found(csmip_pairs(0.02), "time is not equally spaced, expected the corrected record");
  expect_found(replaced(csmip_pairs(), "G/10.", "V/10."), "states no known unit");
  expect_found(replaced(csmip_pairs(), "NO. OF POINTS", "COUNT"), "states no 'No. of points'");
  expect_found(replaced(csmip_pairs(), "=     12", "=     11"), "4 values found, expected 2");
}

TEST(CsmipRecord, ThatIsDamagedOrHasNoAccelerationIsRefused) {
  const auto good = csmip_v2(1, "360 Deg", kGals);
  expect_found(replaced(good, "     9 points of accel", "    10 points of accel"), "expected");
  expect_found(replaced(good, "     9 points of accel", "     8 points of accel"),
               "more values found, expected 8");
  expect_found(replaced(good, "cm/sec2", "furlong"), "the unit 'furlong");
  expect_found(replaced(good, " accel data equally", " velocity data equally"),
               "a record of velocity or displacement, expected acceleration");
  expect_found(replaced(good, "at  .020 sec", "at  .000 sec"), "the time step is 0 s");
  expect_found("Corrected accelerogram 2018 of another network\n1 2 3\n4 5 6\n",
               "no values found below a line such as");
  const auto other_step = replaced(csmip_v2(2, "90", kGals), "at  .020", "at  .010");
  expect_found(good + other_step, "the time step is 0.01 s, and 0.02 s of the channel above");
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(
                  acceleration_in_g(read_record(replaced(good, "in cm/sec2", "in counts")), 1));
            }).find("is no acceleration (counts)"),
            std::string::npos);
}

/// @param step_ms  62nd real of the header
std::string cosmos(const std::string& name = "acceleration",
                   const std::string& unit = "cm/sec2(04)", double step_ms = 10) {
  Values reals(100, -999);
  reals[33] = 0.005;  // of the recorder
  reals[61] = step_ms;
  return "Corrected acceleration    (Format v01.20 with 13 text lines) Src: made\n" +
         lines(7, "text") + "Sta Chan  1: 340 deg (Rcrdr Chan  1) Location: roof\n" +
         lines(4, "text") + " 100 Integer-header values follow on  10 lines, Format= (10I8)\n" +
         lines(10,
               "       2       1       4     120       1    -999    -999   23075     123    -999") +
         " 100 Real-header values follow on  17 lines, Format= (6F13.6)\n" + rows(reals, 6, 13, 6) +
         "  1 Comment line(s) follow, each starting with a \"|\":\n| made\n" +
         fmt::format("      9  {} pts, approx    0 secs, units={},Format=(8F10.5)\n", name, unit) +
         rows(kGals, 8, 10, 5) + "End-of-data for 23075 acceleration\n";
}

TEST(CosmosRecord, IsReadWithTheStepOfItsHeader) {
  const auto motion = read_record(cosmos() + cosmos());

  EXPECT_EQ(motion.format, "COSMOS");
  EXPECT_NEAR(motion.time_step, 0.01, 1e-12);
  ASSERT_EQ(motion.columns.size(), 2U);
  EXPECT_EQ(motion.columns[0].heading, "Sta Chan 1: 340 deg");
  expect_near(acceleration_in_g(motion, 2), in_g(kGals));
  expect_near(acceleration_in_g(read_record(cosmos("acceleration", "g.     (02)")), 1), kGals);
}

TEST(CosmosRecord, OfCountsVelocityOrWithoutAStepIsRefused) {
  expect_found(cosmos("velocity", "cm/sec (05)"), "a record of velocity or displacement");
  expect_found(cosmos("acceleration", "cm/sec2(04)", -999), "the time step is -999 ms");
  expect_found(cosmos("acceleration", "cm/sec2(04)", 900), "expected 0 s in total");
  EXPECT_NE(
      test::error_of([&] {
        static_cast<void>(acceleration_in_g(read_record(cosmos("raw accel.", "counts(50)")), 1));
      }).find("is no acceleration (counts)"),
      std::string::npos);
}

std::string smc(const std::string& title = "2 CORRECTED ACCELEROGRAM",
                const std::string& rate = "  0.2000000E+03") {
  return title + "\n*\nSAF0B\n     1989  10  18    0004 A place\ntext\n" +
         "station = A town, 1295 Street      component=   up\ntext\ntext\n*\n*\n*\n" +
         "    -32768      1989       291         0         4         0    -32768       111\n" +
         "         2         3         3    -32768         0    -32768       101         1\n" +
         "         9    -32768    -32768    -32768    -32768    -32768    -32768    -32768\n" +
         lines(3,
               "    -32768    -32768    -32768    -32768    -32768    -32768    -32768    -32768") +
         "  0.1700000E+39" + rate + "  0.3703700E+02 -0.1218830E+03  0.1800000E+02\n" +
         lines(9, "  0.1700000E+39  0.1700000E+39  0.1700000E+39  0.1700000E+39  0.1700000E+39") +
         "| a comment\n" +
         "-1.5000E+0 1.0025E+2 2.0013E+2-3.0050E+1 0.0000E+0 1.0000E+0 2.0000E+0 3.0000E+0\n" +
         " 4.5000E+0\n";
}

TEST(SmcRecord, IsReadInGal) {
  const auto motion = read_record(smc());

  EXPECT_EQ(motion.format, "SMC");
  EXPECT_NEAR(motion.time_step, 0.005, 1e-12);
  EXPECT_EQ(motion.columns[0].heading, "up");
  expect_near(acceleration_in_g(motion, 1), in_g({-1.5, 100.25, 200.13, -30.05, 0, 1, 2, 3, 4.5}));
}

TEST(SmcRecord, ThatContradictsItsHeaderIsRefused) {
  expect_found(smc("3 VELOCITY"), "'3 VELOCITY': an SMC record, expected one of an accelerogram");
  expect_found(smc("1 UNCORRECTED ACCELEROGRAM", "  0.1700000E+39"),
               "an SMC record with a time for each value, expected the corrected record");
  expect_found(replaced(smc(), "         9    -32768", "        10    -32768"), "expected");
  expect_found(replaced(smc(), "         9    -32768", "         8    -32768"), "expected 8");
  expect_found(replaced(smc(), "       101         1", "       101         2"),
               "expected 2 lines of comment");
  expect_found(smc("2 CORRECTED ACCELEROGRAM", "  0.0000000E+00"), "of 9 values at 0 Hz");
}

std::string cwa() {
  return "#Earthquake Information\n#StationCode: ABC\n#RecordLength(sec): .06\n"
         "#SampleRate(Hz): 50\n#AmplitudeUnit:  gal. DCoffset(corr)\n"
         "#DataSequence: Time U(+); N(+); E(+)\n#Data: 4F10.3\n"
         "     0.000     1.000     2.000     3.000\n"
         "     0.020    10.000    20.000    30.000\n"
         "     0.040    -1.000    -2.000    -3.000\n";
}

TEST(CwaRecord, HasItsComponentsByName) {
  const auto motion = read_record(cwa());

  EXPECT_EQ(motion.format, "CWA");
  EXPECT_NEAR(motion.time_step, 0.02, 1e-12);
  ASSERT_EQ(motion.columns.size(), 3U);
  EXPECT_EQ(motion.columns[1].heading, "N");
  expect_near(acceleration_in_g(motion, 3), in_g({3, 30, -3}));
}

TEST(CwaRecord, ThatContradictsItsHeaderIsRefused) {
  expect_found(replaced(cwa(), ": .06", ": .08"), "12 values found, expected 16");
  expect_found(replaced(cwa(), "(Hz): 50", "(Hz): 100"), "expected 24");
  expect_found(replaced(cwa(), "gal.", "volt"), "the unit 'volt");
  expect_found(replaced(cwa(), "U(+)", "U(-)"), "'U(-)', expected a component such as N(+)");
}

// Any file is read or refused; a reader that crashes or hangs fails the test.
TEST(StationRecord, OfRandomBytesOrCutAnywhereIsReadOrRefused) {
  std::mt19937 random{1};
  const std::string all[] = {csmip_v2(1, "360 Deg", kGals) + csmip_v2(2, "Up", kGals),
                             csmip_v1("g ."),
                             csmip_pairs(),
                             cosmos(),
                             smc(),
                             cwa()};
  const std::string alphabet = "0123456789.,;+-eED \t\n()*|#:=pts";
  for (int trial = 0; trial < 3000; ++trial) {
    std::string content = all[static_cast<std::size_t>(trial) % std::size(all)];
    const auto any = [&](std::size_t most) { return random() % most; };
    if (trial % 3 == 0) content.resize(any(content.size()));
    for (std::size_t i = any(12); i > 0 && !content.empty(); --i)
      content[any(content.size())] = alphabet[any(alphabet.size())];
    static_cast<void>(looks_like_motion(content));
    static_cast<void>(test::error_of([&] {
      const auto motion = read_record(content);
      EXPECT_GT(motion.columns.size(), 0U) << content;
      for (const auto& column : motion.columns)
        for (const double value : column.values) ASSERT_TRUE(std::isfinite(value)) << content;
    }));
  }
}

}  // namespace
}  // namespace rths::sim::records
