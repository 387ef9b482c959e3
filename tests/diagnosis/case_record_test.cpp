// SPDX-License-Identifier: Apache-2.0
// Keys of [[record]] and [channels], which make any recording readable.
#include <rths/cases/case.hpp>

#include <hdf5.h>
#include <matio.h>

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/files.hpp"

namespace rths::diagnosis {
namespace {

using Values = std::vector<double>;

class RecordTest : public ::testing::Test {
 protected:
  RecordTest() {
    folder_.write("log.csv", "t,u,F\n0,0,10\n0.01,1,20\n0.02,2,30\n0.03,3,40\n0.04,4,50\n");
  }
  // A case with one [[record]] to fit; `record` has its keys.
  Case load(const std::string& record, const std::string& channels = kChannels) {
    folder_.write("case.toml", "format = 1\n[channels]\n" + channels + "\n" + record);
    return load_case(folder_.path());
  }
  std::string error(const std::string& record, const std::string& channels = kChannels) {
    const auto message = test::error_of([&] { static_cast<void>(load(record, channels)); });
    const auto at = message.find(folder_.path().string() + "/");
    return at == 0 ? message.substr(folder_.path().string().size() + 1) : message;
  }

  static constexpr const char* kChannels =
      "time = \"t [s]\"\ndisplacement.long = \"u [mm]\"\nforce.long = \"F [kN]\"\n";
  static constexpr const char* kFit = "[[record]]\nfile = \"log.csv\"\nuse = \"fit\"\n";
  test::TemporaryFolder folder_;
};

constexpr const char* kRows =
    "time = \"none\"\ndisplacement.long = \"u [mm]\"\nforce.long = \"F [kN]\"\n";

TEST_F(RecordTest, MayHaveRowsWithoutTime) {
  const Case c = load("[[record]]\nfile = \"log.csv\"\nuse = \"fit\"\nspan_rows = [2, 4]\n", kRows);

  EXPECT_FALSE(c.records[0].has_time);
  EXPECT_EQ(c.records[0].start, 2);
  EXPECT_EQ(c.records[0].time_step, 1);
  EXPECT_EQ(c.records[0].find("force.long")->values, (Values{20e3, 30e3, 40e3}));
}

TEST_F(RecordTest, RefusesTimesOfRowsWithoutTime) {
  EXPECT_EQ(error(std::string{kFit} + "span_s = [0, 1]\n", kRows),
            "case.toml:10:10: the record has no time, expected no span_s: span_rows = [from, to] "
            "selects rows");
  EXPECT_EQ(error(std::string{kFit} + "span_rows = [1, 3]\n"),
            "case.toml:10:13: the record has a time, expected span_s");
  EXPECT_EQ(error(kFit, std::string{kRows} + "rate_Hz = 1\n"),
            "case.toml:6:11: rate_Hz stands beside time = \"none\", expected only one of the two");
  EXPECT_EQ(error(std::string{kFit} + "[model]\nkind = \"servo_axis\"\n", kRows),
            "case.toml:10:1: a model of kind 'servo_axis' needs records with a time, expected "
            "bearing, platen or data");
}

// Recordings of others, where they are at hand: 3000 samples at 100 Hz of one test.
class StrangersTables : public ::testing::TestWithParam<const char*> {};

TEST_P(StrangersTables, AreReadAsTheirCasesNameThem) {
  const auto tables = test::source_tree() / "../shared/data/strangers/tables";
  if (!std::filesystem::exists(tables)) GTEST_SKIP() << "SKIPPED: there is no " << tables;

  const Case c = load_case(tables / GetParam());

  ASSERT_EQ(c.records.size(), 2U);
  EXPECT_EQ(c.records[0].samples(), 1801U);
  EXPECT_EQ(c.records[1].samples(), 2991U);
  const Case other = load_case(tables / "point_case");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(c.records[i].time_step, 0.01, 1e-9);
    for (const auto& role : {std::pair{"displacement.long", 1e-8}, std::pair{"force.long", 1.0}}) {
      const auto &values = c.records[i].find(role.first)->values,
                 &expected = other.records[i].find(role.first)->values;
      for (std::size_t j = 0; j < values.size(); ++j)
        ASSERT_NEAR(values[j], expected[j], role.second) << role.first << " " << j;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, StrangersTables,
                         ::testing::Values("point_case", "dspace_case", "to_file_v5_case"));

// The unit of a row below the names; a factor is a calibration.
TEST_F(RecordTest, RefusesAUnitThatContradictsItsFile) {
  folder_.write("log.csv", "t,u,F\ns,mm,kN\n0,0,10\n0.01,1,20\n0.02,2,30\n0.03,3,40\n");
  const auto channels = [](const std::string& time, const std::string& u, const std::string& f) {
    return "time = \"" + time + "\"\ndisplacement.long = \"" + u + "\"\nforce.long = \"" + f +
           "\"\n";
  };
  EXPECT_EQ(error(kFit, channels("t [s]", "u [mm]", "F [kN]")), "");
  EXPECT_EQ(error(kFit, channels("t [s]", "u [mm]", "F [2 kN]")), "");
  const auto refuses = [&](const std::string& text, const std::string& why) {
    EXPECT_NE(text.find(why), std::string::npos) << text;
  };
  refuses(error(kFit, channels("t [s]", "u [in]", "F [kN]")),
          "is in mm, found [in], expected [mm]");
  refuses(error(kFit, channels("t [s]", "u [mm]", "-F [kip]")),
          "is in kN, found [kip], expected [kN]");
  refuses(error(kFit, channels("t [ms]", "u [mm]", "F [kN]")), "is in s, found [ms], expected [s]");
  folder_.write("log.csv", "t,u [mm],F\ns,in,kN\n0,0,10\n0.01,1,20\n0.02,2,30\n0.03,3,40\n");
  refuses(error(kFit, channels("t [s]", "u [mm]", "F [kN]")),
          "is in in, found [mm], expected [in]");
}

TEST_F(RecordTest, CutsSeveralRecordsOutOfOneFile) {
  const Case c =
      load(std::string{kFit} + "span_s = [0, 0.02]\n" +
           "[[record]]\nfile = \"log.csv\"\nuse = \"held_out\"\nspan_s = [0.02, 0.03]\n" +
           "[[record]]\nfile = \"log.csv\"\nuse = \"fit\"\nspan_s = [0.03, 1]\nname = \"short\"\n");

  ASSERT_EQ(c.records.size(), 3U);
  EXPECT_EQ(c.records[0].name, "log.csv");
  EXPECT_EQ(c.records[0].samples(), 3U);
  EXPECT_EQ(c.records[1].name, "log.csv (2)");
  EXPECT_EQ(c.records[1].find("force.long")->values, (Values{30e3, 40e3}));
  EXPECT_EQ(c.records[1].start, 0.02);
  EXPECT_EQ(c.records[2].name, "short");
  EXPECT_EQ(c.records[2].samples(), 2U);
}

// A proof on fitted data is none.
TEST_F(RecordTest, RefusesAFileThatIsFittedAndHeldOut) {
  const std::string held_out = "[[record]]\nfile = \"log.csv\"\nuse = \"held_out\"\n";

  EXPECT_EQ(error(std::string{kFit} + held_out),
            "case.toml:11:8: log.csv is also a record to fit, from 0 to 0.04 s, expected sections "
            "that do not overlap (span_s) or another file: data that were fitted prove nothing");
  EXPECT_NE(error(std::string{kFit} + "span_s = [0, 0.03]\n" + held_out + "span_s = [0.01, 1]\n")
                .find("is also a record to fit, from 0.01 to 0.03 s"),
            std::string::npos);
  // Another specimen of the same test.
  EXPECT_EQ(load(std::string{kFit} + held_out + "[record.channels]\nforce.long = \"t [kN]\"\n")
                .records.size(),
            2U);
}

TEST_F(RecordTest, RefusesSamplesThatAreComparedTwice) {
  const std::string held_out = "[[record]]\nfile = \"log.csv\"\nuse = \"held_out\"\n";
  const std::string reason =
      ", expected sections that do not overlap (span_s) or another file: samples that are compared "
      "twice count too much";

  EXPECT_EQ(error(std::string{kFit} + kFit),
            "case.toml:11:8: log.csv is also a record to fit, from 0 to 0.04 s" + reason);
  EXPECT_EQ(error(std::string{kFit} + "span_s = [0, 0.01]\n" + held_out +
                  "span_s = [0.01, 0.04]\n" + held_out + "span_s = [0.02, 0.04]\n"),
            "case.toml:16:8: log.csv is also a record to hold out, from 0.02 to 0.04 s" + reason);
}

TEST_F(RecordTest, RefusesACopyOfAnotherRecord) {
  folder_.write("copy.csv", "time,u,F\n5,0,10\n5.01,1,20\n5.02,2,30\n5.03,3,40\n5.04,4,50\n");
  const std::string copy = std::string{kFit} +
                           "[[record]]\nfile = \"copy.csv\"\nuse = \"held_out\"\n"
                           "[record.channels]\ntime = \"time [s]\"\n";

  EXPECT_EQ(error(copy),
            "case.toml:11:8: copy.csv has the values of log.csv, a record to fit, in each channel, "
            "expected another test: data that were fitted prove nothing");
  // Another specimen of the same test.
  EXPECT_EQ(load(copy + "force.long = \"-F [kN]\"\n").records.size(), 2U);
}

// A bearing keeps its damage between two sections of a file. The state of a free-running model at
// the start of a section is not known better from an earlier one.
TEST_F(RecordTest, GivesASectionTheSamplesBeforeItAsItsPast) {
  const std::string sections = std::string{kFit} + "span_s = [0, 0.01]\n" +
                               "[[record]]\nfile = \"log.csv\"\nuse = \"held_out\"\n"
                               "span_s = [0.02, 0.03]\nsettle_s = 0.01\n"
                               "[[record]]\nfile = \"log.csv\"\nuse = \"held_out\"\n"
                               "span_s = [0.03, 1]\nquiet_s = [0.03, 0.05]\n";
  const std::string bearing =
      "[model]\nkind = \"bearing\"\n[model.cubic_stiffness]\nstiffness_N_per_m3 = 1\n";

  const Case joined = load(sections + bearing), apart = load(sections);

  EXPECT_EQ(joined.records[0].samples(), 2U);
  EXPECT_EQ(joined.records[0].settle, 0);
  EXPECT_EQ(joined.records[1].find("force.long")->values, (Values{10e3, 20e3, 30e3, 40e3}));
  EXPECT_NEAR(joined.records[1].settle, 0.03, 1e-12);
  EXPECT_NEAR(joined.records[1].start, 0, 1e-12);
  EXPECT_EQ(joined.records[2].find("force.long")->values, (Values{10e3, 20e3, 30e3, 40e3, 50e3}));
  EXPECT_NEAR(joined.records[2].settle, 0.03, 1e-12);
  EXPECT_EQ(joined.records[2].quiet, (std::pair<std::size_t, std::size_t>{3, 5}));
  EXPECT_EQ(apart.records[1].samples(), 2U);
  EXPECT_EQ(apart.records[2].settle, 0);
}

TEST_F(RecordTest, LeavesSectionsApartThatDoNotMeet) {
  const Case c = load(std::string{kFit} + "span_s = [0, 0.01]\n" +
                      "[[record]]\nfile = \"log.csv\"\nuse = \"held_out\"\n"
                      "span_s = [0.03, 1]\n" +
                      "[model]\nkind = \"bearing\"\n[model.cubic_stiffness]\n"
                      "stiffness_N_per_m3 = 1\n");

  EXPECT_EQ(c.records[1].samples(), 2U);
  EXPECT_EQ(c.records[1].settle, 0);
}

TEST_F(RecordTest, MeasuresTheNoiseOnAWholeReferenceRecord) {
  folder_.write("rest.csv", "t,u,F\n0,0,10\n0.01,0.1,11\n0.02,0,9\n0.03,0.1,10\n");
  const std::string reference =
      std::string{kFit} + "[[record]]\nfile = \"rest.csv\"\nuse = \"reference\"\n";

  const Case whole = load(reference), section = load(reference + "quiet_s = [0.01, 0.03]\n");

  using Span = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(whole.records[0].quiet, std::nullopt);
  EXPECT_EQ(whole.records[1].quiet, (Span{0, 4}));
  EXPECT_EQ(section.records[1].quiet, (Span{1, 3}));
}

TEST_F(RecordTest, RefusesAReferenceRecordWithMotion) {
  EXPECT_EQ(
      error(std::string{kFit} + "[[record]]\nfile = \"log.csv\"\nuse = \"reference\"\n"),
      "case.toml:12:7: displacement.long moves by 0.004 m in log.csv (2), expected no motion: "
      "the record is used to measure the noise; quiet_s = [from, to] selects a section at "
      "rest");
}

TEST_F(RecordTest, RefusesAnEmptySpan) {
  EXPECT_EQ(error(std::string{kFit} + "span_s = [7, 8]\n"),
            "case.toml:10:10: 7 to 8 s contains fewer than two samples; the recording covers 0 to "
            "0.04 s");
  EXPECT_EQ(error(std::string{kFit} + "span_s = [2, 1]\n"),
            "case.toml:10:10: span_s is [2, 1], expected [from, to], from < to");
}

TEST_F(RecordTest, RefusesAQuietSectionOutsideTheRecord) {
  for (const char* section : {"[0, 0.06]", "[-0.02, 0.02]", "[7, 8]"})
    EXPECT_NE(error(std::string{kFit} + "quiet_s = " + section + "\n")
                  .find(" s, expected times within 0 to 0.04 s, which the record covers"),
              std::string::npos);
  EXPECT_EQ(error(std::string{kFit} + "quiet_s = [0.02, 0.025]\n"),
            "case.toml:10:11: quiet_s is 0.02 to 0.025 s, expected at least two samples of 0.01 s");
  EXPECT_EQ(load(std::string{kFit} + "quiet_s = [0, 0.05]\n").records[0].quiet->second, 5U);
}

// Displacement, axis at rest, and force at 100 Hz. The motion begins at 2 s; at rest there is noise
// in steps of 0.01 mm, and a hum of the force.
std::string test_with_rest() {
  std::string text = "t,u,w,F\n";
  for (int i = 0; i < 600; ++i) {
    const double t = i * 0.01, noise = 0.01 * (i * 37 % 11 / 5 - 1);
    const double u = t < 2 ? 0 : 10 * (t - 2) * std::sin(4 * (t - 2));
    text += fmt::format("{:.2f},{:.2f},{:.2f},{:.4f}\n", t, u + noise, -noise,
                        2 * u + 0.3 * std::sin(2 * t));
  }
  return text;
}

TEST_F(RecordTest, RefusesAQuietSectionThatMoves) {
  folder_.write("log.csv", test_with_rest());
  const std::string channels = std::string{kChannels} + "displacement.lat = \"w [mm]\"\n";

  EXPECT_NO_THROW(static_cast<void>(load(std::string{kFit} + "quiet_s = [0, 1.9]\n", channels)));
  EXPECT_EQ(
      error(std::string{kFit} + "quiet_s = [4, 5]\n", channels),
      "case.toml:11:11: displacement.long moves in quiet_s of log.csv: its standard deviation "
      "is 0.0172 m, expected below 0.00643 m, half of that in motion");
  // The ramp is slow, so the section varies little.
  EXPECT_EQ(
      error(std::string{kFit} + "quiet_s = [0, 2.4]\n", channels),
      "case.toml:11:11: displacement.long is not at rest in all of quiet_s of log.csv: its "
      "standard deviation is 0.00131 m from 1.92 to 2.4 s, expected at most 4 times the usual "
      "6.37e-06 m");
}

TEST_F(RecordTest, TakesAConstantOrCoarseChannelForOneAtRest) {
  std::string text = "t,u,F\n";
  for (int i = 0; i < 600; ++i) {
    const double u = i < 200 ? 0 : 10 * std::sin(0.04 * (i - 200));
    const double flips = i == 180 || i == 190 ? 1 : 0;  // of the last bit
    text += fmt::format("{:.2f},{:.2f},{:.0f}\n", i * 0.01, u, u + flips);
  }
  folder_.write("log.csv", text);

  EXPECT_NO_THROW(static_cast<void>(load(std::string{kFit} + "quiet_s = [0, 2]\n")));
}

TEST_F(RecordTest, RefusesTimeThatDoesNotIncrease) {
  folder_.write("log.csv", "t,u,F\n1.19,0,0\n1.19,1,1\n1.19,2,2\n");

  EXPECT_NE(error(kFit).find("row 2 is at 1.19 s, after 1.19 s: time must increase"),
            std::string::npos);
}

TEST_F(RecordTest, RefusesTimeStepsOfNoSensor) {
  folder_.write("log.csv", "t,u,F\n0,0,0\n1e298,1,1\n2e298,2,2\n");

  EXPECT_NE(error(kFit).find("samples are 1e+298 s apart, expected 1e-09 to 1e+06 s"),
            std::string::npos);
}

TEST_F(RecordTest, RefusesTimeBesideARate) {
  EXPECT_EQ(error(kFit, std::string{kChannels} + "rate_Hz = 100\n"),
            "case.toml:6:11: rate_Hz stands beside time, expected only one of the two");
}

TEST_F(RecordTest, MayReplaceTimeByItsRate) {
  const std::string own = std::string{kFit} + "[record.channels]\n";

  EXPECT_EQ(load(own + "rate_Hz = 10\n").records[0].time_step, 0.1);
  EXPECT_NEAR(load(own + "time = \"t [s]\"\n", "rate_Hz = 10\ndisplacement.long = \"u [mm]\"\n")
                  .records[0]
                  .time_step,
              0.01, 1e-12);
}

TEST_F(RecordTest, ReportsTheLineOfAMissingNumber) {
  for (const std::string cell : {"", "one"}) {
    folder_.write("log.csv",
                  "# a comment\nt,u,F\n0,0,10\n0.01,1," + cell + "\n0.02,2,30\n0.03,3,40\n");

    EXPECT_EQ(error(kFit), "log.csv:4: found '" + cell +
                               "' in column 'F', expected a finite number: fill the gap, or "
                               "exclude it by span_s");
    EXPECT_EQ(load(std::string{kFit} + "span_s = [0.02, 1]\n").records[0].samples(), 2U);
  }
}

TEST_F(RecordTest, RefusesOneNameForTwoRecords) {
  const std::string named = std::string{kFit} + "name = \"a\"\n";

  EXPECT_EQ(error(named + named), "case.toml:14:8: two records are named 'a'");
}

TEST_F(RecordTest, ReadsConstantsFromTheCase) {
  const Case c = load(std::string{kFit} + "[record.channels]\n" +
                      "auxiliary.current = \"= 250 [mA]\"\ntemperature = \"= 20 [degC]\"\n");

  EXPECT_EQ(c.records[0].find("auxiliary.current")->values, (Values(5, 0.25)));
  EXPECT_EQ(c.records[0].find("auxiliary.current")->unit, "A");
  EXPECT_NEAR(c.records[0].find("temperature")->values[4], 293.15, 1e-9);
  EXPECT_EQ(error(std::string{kFit} + "[record.channels]\nauxiliary.current = \"= x [A]\"\n"),
            "case.toml:11:21: 'x' is not a number");
}

TEST_F(RecordTest, AppliesSignsAndFactorsOfUnits) {
  const Case c = load(kFit,
                      "time = \"t [s]\"\nforce.long = \"-F [kN]\"\n"
                      "force.lat = \"F [35.15065 N]\"\ninput.torque = \"F [-2 N.m]\"\n");

  EXPECT_EQ(c.records[0].find("force.long")->values[1], -20e3);
  EXPECT_NEAR(c.records[0].find("force.lat")->values[1], 703.013, 1e-9);
  EXPECT_EQ(c.records[0].find("input.torque")->values[1], -40);
}

TEST_F(RecordTest, FindsColumnsThatAreNamedWithTheirUnits) {
  folder_.write("log.csv", "t [s],-F [kN]\n0,1\n0.01,2\n");

  const Case c = load(kFit, "time = \"t [s]\"\nforce.long = \"-F [kN]\"\n");

  EXPECT_EQ(c.records[0].find("force.long")->values, (Values{1e3, 2e3}));
}

TEST_F(RecordTest, TakesChannelsFromSeveralFiles) {
  folder_.write("load.txt", "11\n21\n31\n41\n51\n");

  const Case c = load(kFit,
                      "rate_Hz = 100\ndisplacement.long = \"u [mm]\"\n"
                      "force.long = \"1 [kN] in load.txt\"\n");

  EXPECT_EQ(c.records[0].find("force.long")->values[2], 31e3);
  folder_.write("load.txt", "11\n21\n");
  EXPECT_NE(error(kFit, "time = \"t [s]\"\nforce.long = \"1 [kN] in load.txt\"\n")
                .find("log.csv: force.long has 2 samples, others have 5"),
            std::string::npos);
  EXPECT_EQ(error(kFit, "time = \"t [s]\"\nforce.long = \"1 [kN] load.txt\"\n"),
            "case.toml:4:14: 'load.txt' follows the unit, expected nothing or \"in file\"");
}

TEST_F(RecordTest, AveragesHeldOutputsAtSamples) {
  const std::string channels =
      "time = \"t [s]\"\nforce.long = \"F [kN]\"\nheld = [\"force.long\"]\n";

  EXPECT_EQ(load(kFit, channels).records[0].find("force.long")->values,
            (Values{10e3, 15e3, 25e3, 35e3, 45e3}));
  EXPECT_EQ(error(kFit, "rate_Hz = 1\nforce.long = \"F [kN]\"\nheld = [\"force.lat\"]\n"),
            "case.toml:5:8: there is no channel 'force.lat'");
}

TEST_F(RecordTest, MayHaveItsOwnSamplingRate) {
  folder_.write("fast.csv", "u,F\n0,1\n1,2\n2,3\n");

  const Case c = load(std::string{kFit} +
                          "[[record]]\nfile = \"fast.csv\"\nuse = \"held_out\"\n"
                          "[record.channels]\nrate_Hz = 1000\n" +
                          "[[record]]\nfile = \"fast.csv\"\nuse = \"held_out\"\n"
                          "[record.channels]\nrate_Hz = 100\n",
                      "displacement.long = \"u [mm]\"\nrate_Hz = 500\n");

  EXPECT_EQ(c.records[0].time_step, 2e-3);
  EXPECT_EQ(c.records[1].time_step, 1e-3);
  EXPECT_EQ(c.records[2].time_step, 1e-2);
}

TEST_F(RecordTest, ResamplesUnequallySpacedSamples) {
  folder_.write("log.csv", "t,u,F\n0,0,0\n0.01,1,1\n0.025,2.5,2.5\n0.03,3,3\n0.04,5,4\n");

  const Record record = load(std::string{kFit} + "resample_Hz = 200\n").records[0];

  EXPECT_EQ(record.time_step, 5e-3);
  ASSERT_EQ(record.samples(), 9U);
  EXPECT_NEAR(record.find("force.long")->values[3], 1500, 1e-9);
  EXPECT_NEAR(record.find("displacement.long")->values[7], 4e-3, 1e-12);
  EXPECT_TRUE(record.gaps.empty());
  EXPECT_NE(error(kFit).find("row 3 is at 0.025 s, 0.015 s after row 2 at 0.01 s, expected 0.01 s"),
            std::string::npos);
  folder_.write("log.csv", "t,u,F\n0,0,0\n0.01,1,1\n0.01,2,2\n");
  EXPECT_NE(error(std::string{kFit} + "resample_Hz = 200\n").find("time must increase"),
            std::string::npos);
}

TEST_F(RecordTest, NamesThePlaceOfAMissingFileOnce) {
  std::string without = kFit;
  without.replace(without.find("file = "),
                  without.find('\n', without.find("file = ")) - without.find("file = "), "");
  const std::string refused = error(without);
  EXPECT_NE(refused.find("'file' is missing"), std::string::npos) << refused;
  EXPECT_EQ(refused.find("case.toml"), refused.rfind("case.toml")) << refused;
}

TEST_F(RecordTest, RefusesToResampleOneSampleOrToTooMany) {
  EXPECT_EQ(error(std::string{kFit} + "resample_Hz = 1e9\n"),
            "case.toml:10:15: resampling 0.04 s at 1e+09 Hz makes 4e+07 samples, expected 1 to "
            "20000000");
  EXPECT_EQ(error(std::string{kFit} + "resample_Hz = 1e-6\n"),
            "case.toml:10:15: resampling 0.04 s at 1e-06 Hz makes 4e-08 samples, expected 1 to "
            "20000000");
  folder_.write("log.csv", "t,u,F\n0,0,10\n");
  for (const char* resampled : {"", "resample_Hz = 200\n"})
    EXPECT_EQ(error(std::string{kFit} + resampled),
              "log.csv: found 1 samples, expected at least two");
}

// 100 Hz without the rows from 0.3 to 0.4 s, and without one row.
TEST_F(RecordTest, NamesAGapAndDoesNotCompareItWhenResampled) {
  std::string text = "t,u,F\n";
  for (int i = 0; i < 100; ++i)
    if (i != 60 && (i <= 30 || i >= 40)) text += fmt::format("{:.2f},{},{}\n", i * 0.01, i, i);
  folder_.write("log.csv", text);

  EXPECT_EQ(
      error(kFit),
      "log.csv: row 32 is at 0.4 s, 0.1 s after row 31 at 0.3 s, expected 0.01 s: samples are "
      "not equally spaced; give one record to each section (span_s), or resample_Hz, or "
      "rate_Hz instead of time if only the time stamps are wrong");
  const Record record = load(std::string{kFit} + "resample_Hz = 200\n").records[0];
  ASSERT_EQ(record.gaps.size(), 1U);
  EXPECT_EQ(record.gaps[0], (std::pair<std::size_t, std::size_t>{60, 80}));
}

TEST_F(RecordTest, ReadsTheSettlingTime) {
  EXPECT_EQ(load(kFit).records[0].settle, 0);
  EXPECT_EQ(load(std::string{kFit} + "settle_s = 0.02\n").records[0].settle, 0.02);
  EXPECT_EQ(error(std::string{kFit} + "settle_s = 3\n").find("case.toml:10:12: settle_s is 3"), 0U);
}

TEST_F(RecordTest, ReadsTheRangeOfTheMap) {
  const std::string map = "[map]\ndisplacement_m = 0.5\n";

  const MapRange range = load(kFit + map).map;

  EXPECT_EQ(range.displacement, 0.5);
  EXPECT_FALSE(range.velocity.has_value());
  EXPECT_EQ(error(kFit + map + "velocity_m_per_s = 0\n").find("case.toml:12:20: "), 0U);
}

TEST_F(RecordTest, ReadsTheRateOfTheModel) {
  const Comparison comparison =
      load(std::string{kFit} + "[compare]\nmodel_rate_Hz = 1000\n").comparison;

  EXPECT_EQ(comparison.model_rate, 1000);
  EXPECT_FALSE(comparison.cutoff.has_value());
}

TEST_F(RecordTest, AcceptsHyphensInKindsOfModels) {
  for (const char* spelling : {"mass-spring-damper", "mass_spring_damper", "mass spring damper"})
    EXPECT_EQ(load(std::string{kFit} + "[model]\nkind = \"" + spelling + "\"\n").model.kind,
              ModelKind::MassSpringDamper);
  EXPECT_EQ(load(std::string{kFit} + "[model]\nkind = \"servo-hydraulic axis\"\n").model.kind,
            ModelKind::ServoAxis);
}

class BinaryRecordTest : public RecordTest {
 protected:
  static constexpr double kTime[] = {0, 0.5, 1};
  static constexpr double kBoth[] = {1, 2, 3, 10, 20, 30};  // column by column
  static constexpr double kRowByRow[] = {1, 10, 2, 20, 3, 30};

  void write_mat(const double* both) {
    mat_t* file = Mat_CreateVer((folder_.path() / "log.mat").c_str(), nullptr, MAT_FT_MAT5);
    const auto add = [&](const char* name, const double* values, std::size_t rows,
                         std::size_t columns) {
      std::size_t size[] = {rows, columns};
      matvar_t* variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size,
                                         const_cast<double*>(values), MAT_F_DONT_COPY_DATA);
      Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE);
      Mat_VarFree(variable);
    };
    add("t", kTime, 1, 3);
    add("X", both, 3, 2);
    Mat_Close(file);
  }
  void write_hdf5() {
    const hid_t file =
        H5Fcreate((folder_.path() / "log.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const auto add = [&](const char* name, const double* values, int rank, const hsize_t* size) {
      const hid_t space = H5Screate_simple(rank, size, nullptr);
      const hid_t set =
          H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
      H5Dclose(set);
      H5Sclose(space);
    };
    const hsize_t flat[] = {3}, plane[] = {3, 2};
    add("t", kTime, 1, flat);
    add("X", kRowByRow, 2, plane);
    H5Fclose(file);
  }
  static constexpr const char* kColumns =
      "time = \"t [s]\"\ndisplacement.long = \"X(1) [mm]\"\nforce.long = \"X(2) [kN]\"\n";
};

TEST_F(BinaryRecordTest, ReadsMatFiles) {
  write_mat(kBoth);

  const Record record =
      load("[[record]]\nfile = \"log.mat\"\nuse = \"fit\"\n", kColumns).records[0];

  EXPECT_EQ(record.time_step, 0.5);
  EXPECT_EQ(record.find("displacement.long")->values, (Values{1e-3, 2e-3, 3e-3}));
  EXPECT_EQ(record.find("force.long")->values, (Values{10e3, 20e3, 30e3}));
}

TEST_F(BinaryRecordTest, ReadsHdf5Files) {
  write_hdf5();

  const Record record = load("[[record]]\nfile = \"log.h5\"\nuse = \"fit\"\n", kColumns).records[0];

  EXPECT_EQ(record.time_step, 0.5);
  EXPECT_EQ(record.find("displacement.long")->values, (Values{1e-3, 2e-3, 3e-3}));
  EXPECT_EQ(record.find("force.long")->values, (Values{10e3, 20e3, 30e3}));
}

TEST_F(BinaryRecordTest, ReportsMissingSamples) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double both[] = {1, 2, 3, 10, nan, nan};
  write_mat(both);
  const std::string record = "[[record]]\nfile = \"log.mat\"\nuse = \"fit\"\n";

  EXPECT_EQ(error(record, kColumns),
            "log.mat: force.long is NaN or infinite in sample 2 and 1 others: fill the gap, or "
            "exclude it "
            "by span_s");
}

}  // namespace
}  // namespace rths::diagnosis
