// SPDX-License-Identifier: Apache-2.0
//
// Contradictions of unit, size and file that are found before the start, each with one line.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/experiment.hpp>
#include <rths/launch/run.hpp>

#include "support/files.hpp"

namespace rths::launch {
namespace {

/// Columns of a motion: time, 0.3 and 0.2 times `factor`, a burst of 1 Hz.
std::string record(double factor, double step = 0.01, const std::string& heading = "") {
  std::string text = heading;
  for (int i = 0; i <= 1000; ++i) {
    const double t = 0.01 * i;  // whatever the file states
    const double a =
        factor * std::sin(std::numbers::pi * t / 10) * std::sin(2 * std::numbers::pi * t);
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
  EXPECT_FOUND(found_in("m_s2_named.csv"), "the record is in m/s² ('h1_m/s2')");
  EXPECT_FOUND(found_in("gal_named.csv"), "the record is in gal (cm/s²) ('ns [gal]')");
  EXPECT_FOUND(found_with({{"axes", "[\"long\"]"}, {"motion", "{file = " + file("cm.AT2") + "}"}}),
               "the record is in gal (cm/s²) (' CM/SEC2')");
}

TEST_F(PlausibleTest, AScaleConvertsAUnitOnceAndTheRightWay) {
  const auto scaled = [&](const char* name, const char* scale) {
    return found_with(
        {{"motion", std::string{"{scale = "} + scale + ", file = " + file(name) + "}"}});
  };
  EXPECT_EQ(scaled("gal.csv", "0.00101972"), "");
  EXPECT_EQ(scaled("gal_named.csv", "0.0014"), "");
  EXPECT_FOUND(scaled("g.csv", "9.81"), "the factor from m/s² to g the wrong way");
  EXPECT_FOUND(scaled("g.csv", "0.00101972"), "as for a record in gal (cm/s²)");
}

TEST_F(PlausibleTest, AWrongTimeStepIsRefusedOrSaid) {
  EXPECT_FOUND(found_in("ms.csv"),
               "the time step is 10 s, expected at most 0.1 s: is the time in ms");
  EXPECT_FOUND(found_in("slow.csv"), "is the time step, 0.04 s, ");
}

TEST_F(PlausibleTest, AnAt2FileDrivesOneAxisAndItsContentDecides) {
  EXPECT_FOUND(found_in("h1.AT2"),
               "h1.AT2 is an .AT2 file, which has one component, and would drive both axes");
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

// Inputs of others, where they are at hand.
TEST(StrangersMotions, AreReadRightOrRefused) {
  const auto motions = test::source_tree().parent_path() / "shared/data/strangers/motions";
  if (!std::filesystem::exists(motions)) GTEST_SKIP() << "no " << motions;
  const auto base = motions / "motion_base.toml";
  const auto read = [&](const std::string& name) {
    return app::load_experiment(base, {{"motion.file", "\"" + name + "\""}}).motion;
  };
  const auto error = [&](const std::string& name) {
    return test::error_of([&] { static_cast<void>(read(name)); });
  };
  EXPECT_NEAR(read("g.csv").time_step, 0.005, 1e-12);
  EXPECT_FOUND(error("gal.csv"), "gal");
  EXPECT_FOUND(error("m_s2.csv"), "m/s²");
  for (const char* name :
       {"crlf.AT2", "lower_dt.AT2", "line4_3.AT2", "mixed_case_ext.At2", "at2_named.txt"}) {
    const auto motion =
        app::load_experiment(
            base, {{"motion.file", "\"" + std::string{name} + "\""}, {"axes", "[\"long\"]"}})
            .motion;
    EXPECT_NEAR(motion.time_step, 0.005, 1e-12) << name;
    EXPECT_FOUND(error(name), "would drive both axes");
  }
  EXPECT_FOUND(
      test::error_of([&] { static_cast<void>(app::load_experiment(motions / "single.toml")); }),
      "would drive both axes");
}

}  // namespace
}  // namespace rths::launch
