// SPDX-License-Identifier: Apache-2.0
//
// Contradictions of unit, size and file that are found before the start, each with one line.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <rths/app/builtin_adapters.hpp>
#include <rths/experiment/check.hpp>
#include <rths/launch/run.hpp>

#include "support/files.hpp"

namespace rths::experiment {
namespace {

/// A burst of 1 Hz within 10 s.
double burst(double t) {
  return std::sin(std::numbers::pi * t / 10) * std::sin(2 * std::numbers::pi * t);
}

/// Columns of a motion: time, 0.3 and 0.2 times `factor`, a burst of 1 Hz.
std::string record(double factor, double step = 0.01, const std::string& heading = "") {
  std::string text = heading;
  for (int i = 0; i <= 1000; ++i) {
    const double t = 0.01 * i;  // whatever the file states
    const double a = factor * burst(t);
    text += fmt::format("{:.4f},{:.6f},{:.6f}\n", i * step, 0.3 * a, 0.2 * a);
  }
  return text;
}

std::string at2(double factor, const std::string& unit = "G",
                const std::string& header = "NPTS= 500, DT= .0100 SEC") {
  std::string text =
      "A RECORD\nAN EVENT\nACCELERATION TIME HISTORY IN UNITS OF " + unit + "\n" + header + "\n";
  for (int i = 0; i < 500; ++i)
    text += fmt::format("{:.6e}\n", 0.3 * factor * std::sin(2 * std::numbers::pi * 0.01 * i));
  return text;
}

class PlausibleTest : public ::testing::Test {
 protected:
  PlausibleTest() {
    folder.write("g.csv", record(1));
    folder.write("gal.csv", record(980.665));
    folder.write("m_s2.csv", record(9.80665));
    folder.write("m_s2_named.csv", record(9.80665, 0.01, "t_s,h1_m/s2,h2_m/s2\n"));
    folder.write("gal_named.csv", record(980.665, 0.01, "time [s],ns [gal],ew [gal]\n"));
    folder.write("ms.csv", record(1, 10));
    folder.write("slow.csv", record(1, 0.04));
    folder.write("h1.AT2", at2(1));
    folder.write("h2.At2", at2(0.5));
    folder.write("h3.txt", at2(0.5, "G", "NPTS , DT = 500 , .0100"));
    folder.write("cm.AT2", at2(980, "CM/SEC2"));
    std::string alone;
    for (int i = 0; i <= 1000; ++i) alone += fmt::format("{:.6f}\n", 0.3 * burst(0.01 * i));
    folder.write("alone.txt", alone);
    folder.write("mm.csv", "0,0,0\n0.01,0,0\n0.02,80,40\n0.03,0,0\n");
    folder.write("offset.csv", "0,0.2,0\n0.01,0.2,0\n0.02,0.2,0\n");
  }

  /// The error, or the remarks, of an experiment with changes.
  [[nodiscard]] std::string found_with(const Overrides& changes,
                                       const std::string& example = "srmd_lprb_2d_ats") const {
    Overrides all{{"held_out", "{}"}, {"duration_s", "10"}};
    all.insert(all.end(), changes.begin(), changes.end());
    std::string remarks;
    const auto error = test::error_of([&] {
      const auto experiment =
          app::load_experiment(test::source_tree() / "examples" / (example + ".toml"), all);
      for (const auto& list : {experiment.remarks, check_plausible(experiment)})
        for (const auto& remark : list) remarks += remark + "\n";
    });
    return error.empty() ? remarks : error;
  }
  [[nodiscard]] std::string file(const std::string& name) const {
    return "\"" + (folder.path() / name).string() + "\"";
  }
  [[nodiscard]] std::string found_in(const std::string& motion) const {
    return found_with({{"motion", "{file = " + file(motion) + "}"}});
  }

  [[nodiscard]] sim::GroundMotion motion_of(const std::string& name) const {
    return app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d_ats.toml",
                                {{"held_out", "{}"}, {"motion", "{file = " + file(name) + "}"}})
        .earthquake.motion;
  }

  test::TemporaryFolder folder;
};

#define EXPECT_FOUND(text, part) \
  EXPECT_NE(std::string{text}.find(part), std::string::npos) << (text)

TEST_F(PlausibleTest, NothingIsSaidOfAMotionInGAndOfTheExamples) {
  EXPECT_EQ(found_in("g.csv"), "");
  for (const char* example :
       {"srmd_lprb_2d", "srmd_eqsb_2d", "srmd_tpfb_2d", "srmd_platen_2d", "srmd_lprb_3d",
        "srmd_eqsb_3d", "srmd_tpfb_3d", "mismatch_coupling", "mismatch_tracking_2d"})
    EXPECT_EQ(found_with({}, example), "") << example;
}

TEST_F(PlausibleTest, ARecordInAnotherUnitIsRefusedWithTheLikelyOne) {
  EXPECT_FOUND(found_in("gal.csv"),
               "is the record in gal (cm/s²)? Then expected scale = 0.00101972");
  EXPECT_FOUND(found_in("m_s2.csv"), "is the record in m/s²? Then expected scale = 0.101972");
}

TEST_F(PlausibleTest, ARecordWhoseHeadingStatesAnotherUnitIsConvertedToG) {
  const auto expected = motion_of("g.csv");
  for (const char* name : {"m_s2_named.csv", "gal_named.csv"}) {
    EXPECT_EQ(found_in(name), "") << name;
    const auto motion = motion_of(name);
    ASSERT_EQ(motion.long_acceleration.size(), expected.long_acceleration.size());
    for (std::size_t i = 0; i < motion.long_acceleration.size(); ++i) {
      ASSERT_NEAR(motion.long_acceleration[i], expected.long_acceleration[i], 2e-5) << name;
      ASSERT_NEAR(motion.lat_acceleration[i], expected.lat_acceleration[i], 2e-5) << name;
    }
  }
  EXPECT_EQ(found_with({{"axes", "[\"long\"]"}, {"motion", "{file = " + file("cm.AT2") + "}"}}),
            "");
}

TEST_F(PlausibleTest, AColumnOfValuesAloneNeedsItsStep) {
  EXPECT_FOUND(found_in("alone.txt"), "alone.txt has no column of time, expected time_step_s");
  const auto with = [&](const std::string& name, const std::string& step) {
    return found_with({{"motion", "{time_step_s = " + step + ", file = " + file(name) + "}"}});
  };
  EXPECT_EQ(with("alone.txt", "0.01"), "alone.txt has one component, which drives both axes\n");
  EXPECT_FOUND(with("alone.txt", "0.01, column_lat = 1"), "column_lat has no effect");
  EXPECT_FOUND(with("alone.txt", "0"), "time_step_s is 0, expected");
  EXPECT_FOUND(with("g.csv", "0.01"),
               "time_step_s has no effect: g.csv states a time step of 0.01 s");
  EXPECT_FOUND(with("h1.AT2", "0.01"),
               "time_step_s has no effect: h1.AT2 states a time step of 0.01 s");
}

TEST_F(PlausibleTest, AScaleConvertsAUnitOnceAndTheRightWay) {
  const auto scaled = [&](const char* name, const char* scale) {
    return found_with(
        {{"motion", std::string{"{scale = "} + scale + ", file = " + file(name) + "}"}});
  };
  EXPECT_EQ(scaled("gal.csv", "0.00101972"), "");
  EXPECT_FOUND(scaled("gal_named.csv", "0.0014"),
               "scale is 0.0014, but 'ns [gal]' states gal (cm/s²), which is converted to g: "
               "expected scale = 1.37");
  EXPECT_FOUND(scaled("m_s2_named.csv", "0.101972"), "expected scale = 1");
  EXPECT_EQ(scaled("gal_named.csv", "1.4"), "");
  EXPECT_FOUND(scaled("g.csv", "9.81"), "the factor from m/s² to g the wrong way");
  EXPECT_FOUND(scaled("g.csv", "0.00101972"), "as for a record in gal (cm/s²)");
}

TEST_F(PlausibleTest, AWrongTimeStepIsRefusedOrSaid) {
  EXPECT_FOUND(found_in("ms.csv"),
               "the time step is 10 s, expected at most 0.1 s: is the time in ms");
  EXPECT_FOUND(found_in("slow.csv"), "is the time step, 0.04 s, ");
}

TEST_F(PlausibleTest, AnAt2FileForBothAxesIsSaidAndItsContentDecides) {
  EXPECT_EQ(found_in("h1.AT2"), "h1.AT2 has one component, which drives both axes\n");
  EXPECT_EQ(found_with({{"axes", "[\"long\"]"}, {"motion", "{file = " + file("h1.AT2") + "}"}}),
            "");
  const auto both = [&](const std::string& more) {
    return found_with({{"motion", "{file_long = " + file("h1.AT2") + more + "}"}});
  };
  EXPECT_EQ(both(", file_lat = " + file("h2.At2")), "");
  EXPECT_EQ(both(", file_lat = " + file("h3.txt")), "");
  EXPECT_FOUND(both(", column_long = 2, file_lat = " + file("h2.At2")),
               "column_long has no effect: h1.AT2 is an .AT2 file");
  EXPECT_FOUND(both(", file = " + file("g.csv") + ", file_lat = " + file("h2.At2")),
               "file has no effect: each component has a file of its own");
}

TEST_F(PlausibleTest, NumbersInKilonewtonOrTonnesAreRefused) {
  const auto with = [&](const char* key, const char* value) { return found_with({{key, value}}); };
  EXPECT_FOUND(with("specimen.bouc_wen.characteristic_strength_N", "850"), "is it in kN?");
  EXPECT_FOUND(with("specimen.bouc_wen.post_yield_stiffness_N_per_m", "4000"), "is it in kN/m?");
  EXPECT_FOUND(with("model.specimen.bouc_wen.characteristic_strength_N", "850"), "is it in kN?");
  EXPECT_FOUND(with("machine.effective_mass_kg", "[113, 117]"), "is it in t?");
}

TEST_F(PlausibleTest, CommandedDisplacementsBeyondTheMachineOrFarFromRestAreRefused) {
  const auto targets = [&](const std::string& name) {
    return found_with({{"targets", "{kind = \"file\", file = " + file(name) + "}"}});
  };
  EXPECT_FOUND(targets("mm.csv"), "the machine's stroke is 1.22 m: are they in mm?");
  EXPECT_FOUND(targets("offset.csv"),
               "the first command of long is 0.2 m, expected at most 0.005 m");
}

TEST_F(PlausibleTest, AResponseThatNoMachineReachesIsRefused) {
  folder.write("soft.toml",
               "bearing = 1\ntitle = \"soft\"\n[polynomial_stiffness]\nlinear_N_per_m = 3000\n");
  EXPECT_FOUND(found_with({{"specimen", "{model = " + file("soft.toml") + "}"}}, "srmd_eqsb_2d"),
               "is the stiffness in kN/m?");
  EXPECT_FOUND(found_with({{"motion.scale", "12"}, {"duration_s", "15"}}),
               "and the machine reaches");
}

/// A record of a station: U, N and E in gal, of `samples` at 100 Hz.
std::string station(int samples) {
  std::string text = fmt::format(
      "#StationCode: ABC\n#RecordLength(sec): {}\n#SampleRate(Hz): 100\n#AmplitudeUnit: gal.\n"
      "#DataSequence: Time U(+); N(+); E(+)\n#Data: 4F10.3\n",
      0.01 * samples);
  for (int i = 0; i < samples; ++i)
    text += fmt::format("{:.3f} 1 {:.6f} {:.6f}\n", 0.01 * i, 98.0665 * burst(0.01 * i),
                        196.133 * burst(0.01 * i));
  return text;
}

TEST_F(PlausibleTest, ChannelsOfAStationAreChosenByTheirNumber) {
  folder.write("station.dat", station(1000));
  const std::string of = "{file = " + file("station.dat");

  EXPECT_FOUND(found_with({{"motion", of + "}"}}),
               "station.dat has 3 channels: 1 'U', 2 'N', 3 'E'; expected column_long with the "
               "number of one");
  EXPECT_FOUND(found_with({{"motion", of + ", column_long = 3}"}}), "expected column_lat with");
  const auto motion = app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d_ats.toml",
                                           {{"held_out", "{}"},
                                            {"motion", of + ", column_long = 3, column_lat = 2}"}})
                          .earthquake.motion;
  EXPECT_NEAR(motion.long_acceleration[325], 2 * 0.980665 * burst(3.25), 1e-6);
  EXPECT_NEAR(motion.lat_acceleration[325], 0.980665 * burst(3.25), 1e-6);
}

/// Two channels of CSMIP in g, of 500 and `other` samples at 100 Hz.
std::string two_channels(int other) {
  std::string text = "Uncorrected Accelerogram Data\n";
  for (const int samples : {500, other}) {
    text += fmt::format("Chan {}\n {} Accelerogram points at 100 pts/sec in units of g .\n",
                        samples, samples);
    for (int i = 0; i < samples; ++i) text += fmt::format("{:.6f}\n", 0.3 * burst(0.01 * i));
    text += "/& End of Data\n";
  }
  return text;
}

TEST_F(PlausibleTest, ChannelsOfOneRecorderMayEndApart) {
  folder.write("two.v1", two_channels(497));
  const std::string of = "{file = " + file("two.v1") + ", column_long = 1, column_lat = 2}";

  EXPECT_FOUND(found_with({{"motion", of}}),
               "the channels of two.v1 have 497 to 500 samples; zeros follow the shorter ones");
  // Files of their own may be of different records.
  folder.write("short.AT2", at2(1, "G", "NPTS= 500, DT= .0050 SEC"));
  EXPECT_FOUND(found_with({{"motion", "{file_long = " + file("h1.AT2") +
                                          ", file_lat = " + file("short.AT2") + "}"}}),
               "differ in length or time step: 500 samples of 0.01 s, and 500 of 0.005 s");
}

TEST_F(PlausibleTest, AVerticalColumnIsNoHorizontalComponent) {
  for (const char* name : {"UD [g]", "up", "HNZ", "Vertical (g)"}) {
    folder.write("ud.csv", record(1, 0.01, fmt::format("t [s],ns [g],{}\n", name)));
    EXPECT_FOUND(found_in("ud.csv"), "a vertical component, expected column_lat");
  }
}

// Inputs of others, where they are at hand: all hold the motion of g.csv.
class StrangersMotions : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(motions_)) GTEST_SKIP() << "SKIPPED: there is no " << motions_;
  }
  [[nodiscard]] Experiment load(const std::string& name, Overrides changes = {}) const {
    changes.emplace_back("motion.file", "\"" + name + "\"");
    return app::load_experiment(motions_ / "motion_base.toml", changes);
  }
  [[nodiscard]] std::string error(const std::string& name, const Overrides& changes = {}) const {
    return test::error_of([&] { static_cast<void>(load(name, changes)); });
  }

  std::filesystem::path motions_ =
      test::source_tree().parent_path() / "shared/data/strangers/motions";
};

TEST_F(StrangersMotions, HaveTheSameValuesInAnyFormatAndUnit) {
  const auto expected = load("g.csv").earthquake.motion;
  ASSERT_NEAR(expected.time_step, 0.005, 1e-12);
  for (const auto& entry : std::filesystem::directory_iterator{motions_}) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".toml") continue;
    const Overrides step =
        name == "one_column.txt" ? Overrides{{"motion.time_step_s", "0.005"}} : Overrides{};
    ASSERT_EQ(error(name, step), "") << name;
    const auto motion = load(name, step).earthquake.motion;
    EXPECT_NEAR(motion.time_step, 0.005, 1e-12) << name;
    ASSERT_EQ(motion.long_acceleration.size(), 2000U) << name;
    for (std::size_t i = 0; i < 2000; ++i)  // printed with six decimals of g
      ASSERT_NEAR(motion.long_acceleration[i], expected.long_acceleration[i], 5e-5) << name;
  }
}

TEST_F(StrangersMotions, AreReadOrRefusedByCheckAsByRun) {
  for (const auto& entry : std::filesystem::directory_iterator{motions_}) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".toml") continue;
    const auto checked =
        test::error_of([&] { static_cast<void>(check_motion_file(entry.path())); });
    EXPECT_EQ(checked.empty(), error(name).empty()) << checked << error(name);
  }
  EXPECT_FOUND(error("one_column.txt"), "expected time_step_s");
}

TEST_F(StrangersMotions, OfOneComponentAreSaidToDriveBothAxes) {
  EXPECT_EQ(app::load_experiment(motions_ / "single.toml").remarks,
            std::vector<std::string>{"h1.AT2 has one component, which drives both axes"});
}

}  // namespace
}  // namespace rths::experiment
