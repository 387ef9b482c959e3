// SPDX-License-Identifier: Apache-2.0
//
// Hybrid tests on the machine with six degrees of freedom, as the example runs them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/json.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"

namespace rths::launch {
namespace {

using Json = nlohmann::json;

// The raw delay is the paper's. With the specimen of the test in the simulation, machine and
// control alone make the responses differ.
TEST(PlatenExample, RespondsLikeTheSimulationWithTheSameSpecimen) {
  const test::TemporaryFolder folder;
  const auto run = test::run_rths(
      {"run", (test::source_tree() / "examples/srmd_platen_2d.toml").string(), "--clock", "virtual",
       "--no-diagnosis", "--set", test::is_long() ? "duration_s=20" : "duration_s=12", "--set",
       "held_out={}", "--set", "model.specimen.lead_heating.enabled=true", "--out",
       folder.path().string()},
      120);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json report = test::json_of(folder.path() / "report.json");

  for (const char* name : {"long", "lat"}) {
    const Json& axis = report["axes"][name];
    EXPECT_GT(axis["delay_raw_ms"], 55) << name;
    EXPECT_LT(axis["delay_raw_ms"], 65) << name;
    EXPECT_LT(std::abs(double{axis["delay_compensated_ms"]}), 1.5) << name;
    EXPECT_LT(axis["nrms_percent"], 0.5) << name;
    EXPECT_LT(axis["numerical_difference_percent"], 3) << name;
  }
}

test::Finished run_3d(const std::filesystem::path& out, std::vector<std::string> sets,
                      const std::string& example = "srmd_lprb_3d") {
  std::vector<std::string> arguments{
      "run",     (test::source_tree() / "examples" / (example + ".toml")).string(),
      "--clock", "virtual",
      "--set",   "duration_s=8",
      "--set",   "uncompensated={}",
      "--out",   out.string()};
  for (auto& set : sets) arguments.insert(arguments.end(), {"--set", std::move(set)});
  return test::run_rths(arguments, 120);
}

// The goals of the vertical force: 2 % of peak to peak.
TEST(ThreeDimensionsExample, TracksTheVerticalForceThatItFeedsBack) {
  const test::TemporaryFolder folder;
  const auto run = run_3d(folder.path(), {"duration_s=9"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const recording::Reader recorded{folder.path() / "run.h5"};
  const auto command = recorded.signal("monitor.xpc.vertical_load.out");
  const auto measured = recorded.signal("monitor.xpc.vertical_measured.out");

  double sum = 0, low = 1e9, high = -1e9;
  std::size_t count = 0;
  for (std::size_t i = 3000; i < 10'000; ++i, ++count) {
    sum += (measured[i] - command[i]) * (measured[i] - command[i]);
    low = std::min(low, command[i]);
    high = std::max(high, command[i]);
  }
  EXPECT_GT(high - low, 5e6);
  EXPECT_LT(std::sqrt(sum / static_cast<double>(count)), 0.02 * (high - low));
  EXPECT_NE(recorded.signal("daq.vert.force.fbk").back(), 0);

  const Json vertical = test::json_of(folder.path() / "report.json")["vertical"];
  const double error = 100 * std::sqrt(sum / static_cast<double>(count)) / (high - low);
  EXPECT_NEAR(vertical["rms_percent"], error, 0.1 * error);  // from the first target on
  EXPECT_LT(std::abs(double{vertical["delay_ms"]}), 2);
  EXPECT_GT(vertical["tracking_bands"][3]["coherence"], 0.95);  // 6 to 11 Hz: the vertical mode
  EXPECT_NE(run.out.find("vert    force: delay "), std::string::npos) << run.out;
}

// The flags are read once per tick, but atTarget is raised when the target's tick begins. So the
// prediction lasts no longer than the computing time, as with a poll at every substep.
TEST(ThreeDimensionsExample, PredictsNoLongerThanTheSolverComputes) {
  const test::TemporaryFolder folder;

  const auto run =
      run_3d(folder.path(), {"duration_s=2", "solver.computing_time_s=0.0015",
                             "solver.computing_time_spread=0", "conclusive.response=1"});

  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NEAR(test::json_of(folder.path() / "report.json")["predict_ms_mean"], 1, 0.01);
}

class ThreeDimensionsSlider : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Bearings, ThreeDimensionsSlider, testing::Values("eqsb", "tpfb"));

// The goals of the vertical force, and no limit of the machine reached.
TEST_P(ThreeDimensionsSlider, TracksTheVerticalForceWithinTheLimits) {
  const test::TemporaryFolder folder;

  const auto run =
      run_3d(folder.path(), {"duration_s=9"}, std::string{"srmd_"} + GetParam() + "_3d");

  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const Json vertical = test::json_of(folder.path() / "report.json")["vertical"];
  EXPECT_LT(vertical["rms_percent"], 2);
  EXPECT_LT(std::abs(double{vertical["delay_ms"]}), 2);
  EXPECT_GT(vertical["tracking_bands"][3]["coherence"], 0.95);  // 6 to 11 Hz: the vertical mode
}

// RMS error of the vertical force [% of peak to peak] of a test of 9 s.
double vertical_error(const std::string& example, std::vector<std::string> sets) {
  const test::TemporaryFolder folder;
  sets.insert(sets.end(), {"duration_s=9", "conclusive.response=1"});
  const auto run = run_3d(folder.path(), std::move(sets), example);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return test::json_of(folder.path() / "report.json")["vertical"]["rms_percent"];
}

// It gets higher by u²/(2 R): 1.3 mm at 136 mm are 7 MN that a controller without R does not
// expect.
TEST(ThreeDimensionsExample, NeedsTheHeightOfThePendulum) {
  const double with = vertical_error("srmd_tpfb_3d", {});
  const double without =
      vertical_error("srmd_tpfb_3d", {"node.xpc.blocks.vertical.lift_radius_m=0"});

  EXPECT_LT(with, without / 2);
}

// With an inverse that leads by too little, the platen is 12 ms behind its command, and so is the
// height of the pendulum.
TEST(ThreeDimensionsExample, FollowsTheHeightAtThePlaten) {
  const auto error_with = [](const std::string& horizontal) {
    return vertical_error("srmd_tpfb_3d",
                          {"node.srmd.family_member=11", "node.xpc.tune.inverse.adapt=0",
                           "node.xpc.blocks.inverse.a1_s=[0.040, 0.042]",
                           "node.xpc.blocks.vertical.in.horizontal_target=" + horizontal});
  };

  EXPECT_LT(error_with("displacement"), 0.9 * error_with("pc.command"));
}

// A test beside itself differs by nothing.
TEST(Report, PutsAnotherTestBesideThis) {
  const test::TemporaryFolder folder;
  ASSERT_EQ(run_3d(folder.path(), {"duration_s=1", "rate=2", "rest_s=0.2", "conclusive.response=1"})
                .exit_code,
            0);

  const auto both =
      test::run_rths({"report", folder.path().string(), "--beside", folder.path().string()});

  EXPECT_EQ(both.exit_code, 0) << both.err;
  EXPECT_NE(both.out.find("2 times slower, long 0.0 %, lat 0.0 % apart"), std::string::npos)
      << both.out;
  const Json numbers = test::json_of(folder.path() / "report.json");
  EXPECT_EQ(numbers["beside"]["axes"]["long"]["beside_difference_percent"], 0);
  EXPECT_EQ(numbers["beside"]["axes"]["lat"]["beside_peak_shear_kN"],
            numbers["axes"]["lat"]["peak_shear_kN"]);
  const test::TemporaryFolder single;
  ASSERT_EQ(
      run_3d(single.path(), {"duration_s=1", "axes=[\"long\"]", "conclusive.response=1"}).exit_code,
      0);
  const auto lacks =
      test::run_rths({"report", folder.path().string(), "--beside", single.path().string()});
  EXPECT_EQ(lacks.exit_code, 2);
  EXPECT_NE(lacks.err.find("has no axis lat, which this test has"), std::string::npos) << lacks.err;
  const auto none = test::run_rths({"report", folder.path().string(), "--beside", "/no/run"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("/no/run/run.h5"), std::string::npos) << none.err;
}

// With the force of a perfect machine, the fed-back force is that of the plant's own spring and
// dashpot. A force that answers the command of the tick before takes 3 % of damping: a third more.
TEST(ThreeDimensionsExample, AnswersTheTargetNotTheTickBefore) {
  const test::TemporaryFolder folder;
  const auto span_with = [&](const std::string& feedback) {
    const auto out = folder.path() / feedback;
    const auto run = run_3d(out, {"duration_s=9", "node.opf.vertical_feedback=" + feedback});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return test::json_of(out / "report.json")["vertical"]["peak_to_peak_kN"].get<double>();
  };

  const double model = span_with("model");

  EXPECT_NEAR(span_with("measured"), model, 0.15 * model);
}

// Its force is later than the nominal machine's, which excites the vertical mode without
// correction.
TEST(ThreeDimensionsExample, CorrectsTheLagOfALaterMachine) {
  const double with = vertical_error("srmd_lprb_3d", {"node.srmd.family_member=5"});
  const double without = vertical_error(
      "srmd_lprb_3d", {"node.srmd.family_member=5", "node.xpc.blocks.vertical_lag.enabled=0"});

  EXPECT_LT(with, 0.8 * without);
}

// The reference leads the platen by five times its motion. Standing where a trip finds it, it would
// unload the specimen within 80 ms.
TEST(ThreeDimensionsExample, KeepsTheSpecimenLoadedAfterATrip) {
  const test::TemporaryFolder folder;

  const auto run = run_3d(folder.path(), {"node.srmd.safety.displacement_m=[1.22,0.61,0.005]"});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find(" s: vert: displacement of the command and a stop "), std::string::npos)
      << run.err;
  const auto report = test::content_of(folder.path() / "report.json");
  EXPECT_NE(report.find("displacement of the command and a stop from it of vert is "),
            std::string::npos);
  const auto force =
      recording::Reader{folder.path() / "run.h5"}.signal("monitor.srmd.true.force.vert");
  // Weight 9.7 MN; the structure commands 3.2 to 14.6 MN in the whole test.
  EXPECT_GT(*std::min_element(force.begin() + 100, force.end()), 3e6);
  EXPECT_LT(*std::max_element(force.begin(), force.end()), 16e6);
}

// Its delay of 40 ms is a negative damping far above the plant's. The safety layer ends the test.
TEST(ThreeDimensionsExample, EndsSafelyWhereTheCascadeIsUnstable) {
  const test::TemporaryFolder folder;
  const auto run = run_3d(folder.path(), {"node.xpc.blocks.vertical.law=cascade",
                                          "node.xpc.blocks.vertical_lag.enabled=0"});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("srmd: safety trip at "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(" s: vert: "), std::string::npos) << run.err;
  const recording::Reader recorded{folder.path() / "run.h5"};
  for (const double reference : recorded.signal("srmd.vert.displ.ref_echo"))
    ASSERT_LT(std::abs(reference), 0.127);
  for (const double force : recorded.signal("monitor.srmd.true.force.vert"))
    ASSERT_LT(force, 53.4e6);
}

TEST(ThreeDimensionsExample, RefusesAnUnknownLaw) {
  const test::TemporaryFolder folder;
  const auto run = run_3d(folder.path(), {"node.xpc.blocks.vertical.law=pid"});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("law is 'pid', expected lead or cascade"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace rths::launch
