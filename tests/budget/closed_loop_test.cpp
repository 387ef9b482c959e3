// SPDX-License-Identifier: Apache-2.0
//
// The closed loop of a budget against runs in virtual time, which it does not share its code with:
// adapters, ring, handshake and diagram.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/run.hpp>
#include <rths/session/companions.hpp>
#include <rths/session/hybrid_test.hpp>

#include "closed_loop_run.hpp"

namespace rths::budget {
namespace {

using test::apart;
using test::ClosedLoop;

// Recordings hold floats.
TEST_F(ClosedLoop, ReturnsTheRecordedTargetsUnderTheRecordedForce) {
  make(true);
  const Response again = replayed(hybrid, force);
  ASSERT_GE(again[0].size(), measured[0].size());
  EXPECT_LT(difference(again), 1e-4);
}

TEST_F(ClosedLoop, ReproducesARunWithoutNoiseFromTheTrueLaboratory) {
  make(false);
  EXPECT_LT(difference(closed_loop(hybrid, kAll)), 1e-4);
  for (const auto part :
       {Part::Tracking, Part::Force, Part::Specimen, Part::Machine, Part::Numerical})
    EXPECT_GT(difference(closed_loop(hybrid, kAll & ~only(part))), 4e-4) << name_of(part);
}

// The untested axis is at rest and gives no force.
TEST_F(ClosedLoop, ReproducesARunAlongOneAxis) {
  make(false, {{"axes", "[\"long\"]"}});
  const Response response = closed_loop(hybrid, kAll);
  EXPECT_LT(apart(measured[0], response[0]), 1e-4);
  for (const double x : response[1]) EXPECT_EQ(x, 0);
}

// The controller waits for the accelerometer with force and displacement.
TEST_F(ClosedLoop, ReproducesLateSensors) {
  const auto constants = temporary.write("constants.toml",
                                         "[observer]\naccelerometer_delay_s = [0.0016, 0.0016]\n"
                                         "displacement_lead_s = [0.0004, 0.0004]\n");
  make(false, {{"machine.late_accelerometer.kind", "time_skew"},
               {"machine.late_accelerometer.channel", "acceleration"},
               {"machine.late_accelerometer.skew_s", "0.002"},
               {"machine.late_load_cells.kind", "time_skew"},
               {"machine.late_load_cells.channel", "force"},
               {"machine.late_load_cells.skew_s", "0.0004"},
               {"node.xpc.constants", constants.string()}});
  EXPECT_TRUE(hybrid.target_force_waits);
  EXPECT_LT(difference(closed_loop(hybrid, kAll)), 1e-4);

  hybrid.target_force_waits = false;
  EXPECT_GT(difference(closed_loop(hybrid, kAll)), 1e-3);
}

TEST_F(ClosedLoop, ReproducesTheForceAhead) {
  const auto constants = temporary.write("constants.toml", "[target_force]\nlead_time_s = 0.016\n");
  make(false, {{"node.xpc.constants", constants.string()}});
  EXPECT_LT(difference(closed_loop(hybrid, kAll)), 1e-4);

  hybrid.target_force->lead_time = 0;
  EXPECT_GT(difference(closed_loop(hybrid, kAll)), 1e-3);
}

TEST_F(ClosedLoop, TakesTheMemoryOfTheForceFromTheConstants) {
  const auto constants = temporary.write(
      "constants.toml", "[target_force]\nforgetting_s = 2\nmotion_bandwidth_Hz = 2\n");
  make(false, {{"node.xpc.constants", constants.string()}});
  EXPECT_EQ(hybrid.target_force->forgetting, 2);
  EXPECT_EQ(hybrid.target_force->motion_bandwidth, 2);
  EXPECT_LT(difference(closed_loop(hybrid, kAll)), 1e-4);
}

TEST_F(ClosedLoop, ReproducesADelayedSample) {
  const auto constants =
      temporary.write("constants.toml", "[pc]\nsampling_delay_s = [0.001, 0.0005]\n");
  make(false, {{"node.xpc.constants", constants.string()}});
  EXPECT_EQ(hybrid.sampling_delay, (std::array{10, 5}));
  EXPECT_LT(difference(closed_loop(hybrid, kAll)), 1e-4);

  hybrid.sampling_delay = {0, 0};
  EXPECT_GT(difference(closed_loop(hybrid, kAll)), 5e-4);
}

TEST_F(ClosedLoop, HasNoBudgetIfTheTargetsCarryRates) {
  const auto constants = temporary.write("constants.toml", "[pc]\ntargets_carry_rates = true\n");
  make(false, {{"node.xpc.constants", constants.string()}});
  const recording::Reader run{folder / "run.h5"};
  EXPECT_EQ(test::error_of([&] {
              static_cast<void>(session::budget_of_run(experiment, experiment, run, nullptr));
            }),
            experiment.file.string() +
                ": the targets carry rates, which a mismatch budget does not repeat");
}

TEST_F(ClosedLoop, ReproducesASlowRunWithOverruns) {
  make(false, {{"rate", "2"}, {"solver.overrun_fraction", "0.05"}, {"solver.overrun_s", "0.012"}});
  EXPECT_LT(difference(closed_loop(hybrid, kAll)), 1e-3);
}

// Nothing identified is the numerical result of the run.
TEST_F(ClosedLoop, IsTheNumericalResultWithEveryPartAsSimulated) {
  make(true);
  const auto file = folder / "numerical.h5";
  session::run_numerical(experiment, file, "");
  const recording::Reader numerical{file};
  const Response simulated = closed_loop(hybrid, kNone);
  for (const int axis : {0, 1}) {
    const auto all = numerical.signal(axis == 0 ? "result.displ.long" : "result.displ.lat");
    std::vector<double> at_steps;
    for (std::size_t i = 9; i < all.size(); i += 10) at_steps.push_back(all[i]);
    EXPECT_LT(apart(at_steps, simulated[static_cast<std::size_t>(axis)]), 0.01);
  }
}

TEST_F(ClosedLoop, IsExplainedByTheBudgetOfTheRun) {
  make(true);
  const recording::Reader run{folder / "run.h5"};
  const auto found = session::budget_of_run(experiment, as_in_the_laboratory(), run, &run);
  ASSERT_EQ(found.axes.size(), 2U);
  EXPECT_LT(found.replay, 1e-4);
  EXPECT_TRUE(is_tracking_identified(found));
  for (const auto& axis : found.axes) {
    double sum = axis.remainder;
    for (const double share : axis.share) sum += share;
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_NEAR(axis.remainder, std::pow(axis.after / axis.before, 2), 1e-9);
    EXPECT_LT(axis.after, 0.03) << name_of(axis.axis);
    EXPECT_GT(axis.before, 3 * axis.after) << name_of(axis.axis);
    // The controller corrects its force for the tracking error, but knows no heating of the lead.
    EXPECT_GT(axis.share[static_cast<std::size_t>(Part::Specimen)], 0.5) << name_of(axis.axis);
  }
}

// The lists of a diagram for a test along one axis hold one value.
TEST_F(ClosedLoop, HasABudgetThatAddsUpWithoutAnyDifference) {
  make(true);
  const recording::Reader run{folder / "run.h5"};
  const Response simulated = closed_loop(hybrid, kNone);

  const auto found = mismatch_budget(
      hybrid, simulated,
      {session::transfer_record_of(experiment.roles, run, "long", hybrid.host.order),
       session::transfer_record_of(experiment.roles, run, "lat", hybrid.host.order)},
      force);

  for (const auto& axis : found.axes) {
    EXPECT_EQ(axis.before, 0) << name_of(axis.axis);
    EXPECT_EQ(axis.remainder, 1) << name_of(axis.axis);
    for (const double share : axis.share) EXPECT_EQ(share, 0) << name_of(axis.axis);
  }
}

TEST_F(ClosedLoop, ReadsConstantsOfOneAxis) {
  const auto constants =
      temporary.write("constants.toml", "[observer]\neffective_mass_kg = [113369]\n");
  make(false, {{"axes", "[\"long\"]"}, {"node.xpc.constants", constants.string()}});

  const auto& correction = std::get<loop::TableForceCorrection>(hybrid.correction);
  EXPECT_EQ(correction.machine[0].effective_mass, 113369);
  EXPECT_EQ(correction.machine[1].effective_mass, 0);
}

// Without that correction, the tracking error is the largest part.
TEST_F(ClosedLoop, FindsTheLargestShareInTheTrackingOfAts) {
  source = test::source_tree() / "examples/srmd_lprb_2d_ats.toml";
  make(true);
  const recording::Reader run{folder / "run.h5"};
  const auto found = session::budget_of_run(experiment, as_in_the_laboratory(), run, nullptr);
  ASSERT_EQ(found.axes.size(), 2U);
  for (const auto& axis : found.axes) {
    EXPECT_LT(axis.after, 0.03) << name_of(axis.axis);
    EXPECT_GT(axis.share[static_cast<std::size_t>(Part::Tracking)], 0.5) << name_of(axis.axis);
  }
}

// The coefficients of the recording, not those of the start, invert the machine.
TEST_F(ClosedLoop, ReplaysTheAdaptiveInverseAsSent) {
  make(false);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(std::holds_alternative<SentInverse>(hybrid.compensation[i]));
    auto& sent = std::get<SentInverse>(hybrid.compensation[i]).coefficients;
    EXPECT_NE(sent.front(), sent.back());
    sent.assign(1, sent.front());
  }
  EXPECT_GT(difference(closed_loop(hybrid, kAll)), 2e-3);
}

// The example with other names of its nodes.
std::filesystem::path renamed_example(const test::TemporaryFolder& folder) {
  std::string map = test::content_of(test::source_tree() / "memmap/maps/srmd.ringmap.toml");
  std::string text = test::content_of(test::source_tree() / "examples/srmd_lprb_2d.toml");
  const auto replace = [](std::string& in, const std::string& from, const std::string& to) {
    std::size_t at = in.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    for (; at != std::string::npos; at = in.find(from, at + to.size()))
      in.replace(at, from.size(), to);
  };
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"xpc", "target"},
                                 {"srmd", "rig"},
                                 {"opf", "integrator"}}) {
    replace(map, "\n" + from + " = ", "\n" + to + " = ");
    replace(map, "node = \"" + from + "\"", "node = \"" + to + "\"");
    replace(text, "[node." + from + "]", "[node." + to + "]");
  }
  replace(text, "[uncompensated.xpc]", "[uncompensated.target]");
  replace(text, "map = \"srmd\"", "map = \"" + folder.write("map.toml", map).string() + "\"");
  replace(text, "format = 1\n",
          "format = 1\nfolder = \"" + (test::source_tree() / "examples").string() + "\"\n");
  return folder.write("renamed.toml", text);
}

TEST_F(ClosedLoop, DoesNotDependOnTheNamesOfTheNodes) {
  make(true);
  const auto expected = measured;
  const auto expected_force = force;
  const auto expected_arrivals = hybrid.host.computing;

  source = renamed_example(temporary);
  make(true);

  EXPECT_EQ(experiment.roles.controller, "target");
  EXPECT_EQ(measured, expected);
  EXPECT_EQ(force, expected_force);
  EXPECT_EQ(hybrid.host.computing, expected_arrivals);
}

// The run draws its own noise and adapts its own compensation; both loops contain the same
// laboratory. What the noise does to the response bounds their difference.
TEST_F(ClosedLoop, IsRepeatedByARunOfTheImprovedExperiment) {
  make(true);
  const recording::Reader run{folder / "run.h5"};
  const auto found = session::budget_of_run(experiment, as_in_the_laboratory(), run, nullptr);
  const Response with = closed_loop(hybrid, kAll);
  hybrid.noise = {};
  const Response without = closed_loop(hybrid, kAll);
  Config file = Config::load(experiment.file);
  file.put("duration_s", 10);
  file.put("rest_s", 0.5);

  file.set("model", Config{});  // the specimen and the machine of the laboratory are as identified
  file = session::improved_experiment(file, "", found);
  file.put("folder", experiment.file.parent_path().string());
  std::ofstream{folder / "improved.toml"} << file.to_toml();
  launch::RunOptions options;
  options.clock = launch::ClockKind::Virtual;
  options.recording = folder / "improved.h5";
  const auto again = app::load_experiment(folder / "improved.toml");
  ASSERT_TRUE(launch::run(again, options).completed);

  const Response response = session::response_of(again, recording::Reader{options.recording});
  for (const std::size_t axis : {0U, 1U}) {
    const double tolerance = 2 * apart(without[axis], with[axis]) + found.axes[axis].after;
    EXPECT_LT(tolerance, 0.03);
    EXPECT_LT(apart(found.axes[axis].improved, response[axis]), tolerance);
    EXPECT_LT(apart(measured[axis], response[axis]), 0.03);
  }
}

TEST(ImprovedExperiment, ReplacesAMachineOfAFileByTheIdentifiedOne) {
  const Config file = Config::load(test::source_tree() / "examples/srmd_platen_2d.toml");
  const Config node = session::improved_experiment(file, "", {}).table("node").table("srmd");
  EXPECT_EQ(node.keys(), std::vector<std::string>{"adapter"});
}

TEST_F(ClosedLoop, NoiseOfTheForceExplainsMostOfWhatNoiseDoes) {
  make(true);
  const double with = difference(closed_loop(hybrid, kAll));
  hybrid.noise = {};
  EXPECT_LT(with, 0.8 * difference(closed_loop(hybrid, kAll)));
}

TEST(NoiseOf, IsZeroForAParabolaAndKeepsMostOfWhiteNoise) {
  std::vector<double> parabola, white;
  std::mt19937_64 random{1};
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20'000; ++i) {
    parabola.push_back(1 + 2e-3 * i - 3e-6 * i * i);
    white.push_back(normal(random));
  }
  for (const double value : noise_of(parabola, 10)) EXPECT_NEAR(value, 0, 1e-9);
  double sum = 0;
  const auto noise = noise_of(white, 10);
  for (const double value : noise) sum += value * value;
  // 1 less the middle weight of the smoothing parabola of 21 points, 329/3059.
  EXPECT_NEAR(sum / 20'000, 1 - 329.0 / 3059, 0.02);
}

}  // namespace
}  // namespace rths::budget
