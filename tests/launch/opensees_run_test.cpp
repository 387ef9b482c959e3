// SPDX-License-Identifier: Apache-2.0
// Runs with the real, unmodified OpenSees as the solver.
#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>

#include "opensees_run.hpp"
#include "support/json.hpp"

namespace rths {
namespace {

using Json = nlohmann::json;

TEST_F(OpenSeesRun, FeelsABearingOnTheRingAsItsOwn) {
  const auto finished = run(experiment({kIdeal, kPlant, plant_arguments(), kBoth}), "virtual");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const Rows ring = ring_response(), own = own_response("plasticity");
  ASSERT_EQ(own.size(), steps());
  ASSERT_EQ(ring.size(), own.size());
  // Displacements on the ring are float32: 7 digits.
  for (std::size_t column = 1; column <= 4; ++column)
    EXPECT_LT(nrmse(ring, own, column), 1e-4) << column;
}

// Targets of the project's own solver of the same plant, through the same controller and machine.
// Like OpenSees in virtual time, it computes in no time.
Rows targets_of_own_solver(const std::string& experiment, const std::filesystem::path& out,
                           const std::string& seed, int duration) {
  const auto finished =
      test::run_rths({"run", experiment, "--clock", "virtual", "--out", out.string(), "--set",
                      "node.opf={adapter=\"numerical\"}", "--set", "solver.computing_time_s=0",
                      "--set", "seed=" + seed, "--set", fmt::format("duration_s={}", duration)});
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  const recording::Reader reader{out / "run.h5"};
  const auto time = reader.signal("opf.1.time.target"),
             along = reader.signal("opf.long.displ.target"),
             across = reader.signal("opf.lat.displ.target");
  Rows rows;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (time[i] > (i == 0 ? 0 : time[i - 1])) rows.push_back({time[i], along[i], across[i]});
  return rows;
}

// The loop amplifies the noise of the sensors: the machine's residual delay has a large effect with
// so stiff a bearing. The same solver with another noise is therefore the measure: OpenSees with
// the same noise is closer.
TEST_F(OpenSeesRun, MovesTheMachineThroughTheController) {
  duration_ = 30;  // less has too little strong motion
  const std::string file = experiment({kMachine, kPlant, plant_arguments(), kBoth});
  const auto finished = run(file, "virtual");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_TRUE(std::filesystem::exists(out() / "report.html"));
  const Rows ring = ring_response();
  const Rows same_noise = targets_of_own_solver(file, folder_.path() / "same", "1", duration_),
             other_noise = targets_of_own_solver(file, folder_.path() / "other", "2", duration_);
  ASSERT_EQ(ring.size(), steps());
  ASSERT_EQ(same_noise.size(), ring.size());
  ASSERT_EQ(other_noise.size(), ring.size());
  for (const std::size_t axis : {1U, 2U})
    EXPECT_LT(nrmse(ring, same_noise, axis), nrmse(other_noise, same_noise, axis)) << axis;
}

// Rows at which a signal rises above 0 (or falls back to 0).
std::vector<std::size_t> edges(const std::vector<double>& signal, bool rising) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 1; i < signal.size(); ++i)
    if ((signal[i] > 0) != (signal[i - 1] > 0) && (signal[i] > 0) == rising) rows.push_back(i);
  return rows;
}

// Not with the project's own plant, nor with the specimen, whose strength is half of the model's.
TEST_F(OpenSeesRun, HasTheNumericalResultOfItsOwnStructureAndTheModel) {
  const std::string file = experiment({kIdeal, kPlant, plant_arguments(), kBoth});
  const auto weak = test::run_rths(
      {"run", file, "--clock", "virtual", "--out", out().string(), "--set",
       "specimen.bilinear.characteristic_strength_N=505_000", "--set",
       "model.specimen.bilinear.characteristic_strength_N=1_010_000", "--set", "conclusive={}"});
  EXPECT_EQ(weak.exit_code, 1) << weak.err;
  EXPECT_NE(weak.out.find("% from the numerical result, expected at most 10 %"), std::string::npos)
      << weak.out;
  const Rows own = own_response("plasticity"), again = read_rows(out() / "numerical.csv");
  ASSERT_EQ(again.size(), own.size());
  const recording::Reader numerical{out() / "numerical.h5"};
  ASSERT_EQ(numerical.rows(), own.size());
  for (const std::size_t axis : {1U, 2U}) {
    EXPECT_LT(nrmse(again, own, axis), 1e-4);
    const auto targets = numerical.signal(axis == 1 ? "result.displ.long" : "result.displ.lat");
    Rows rows;  // predicted displacements, not those at the end of the step
    for (std::size_t i = 0; i < own.size(); ++i) rows.push_back({0, targets[i], targets[i]});
    EXPECT_LT(nrmse(rows, own, axis), 0.02);
  }
  const Json report = test::json_of(out() / "report.json");
  for (const char* axis : {"long", "lat"})
    EXPECT_GT(report["axes"][axis]["numerical_difference_percent"], 10) << axis;
}

TEST_F(OpenSeesRun, IsCheckedWithoutARecording) {
  const auto checked =
      test::run_rths({"check", experiment({kIdeal, kPlant, plant_arguments(), kBoth})});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
}

TEST_F(OpenSeesRun, IsItsNumericalResultIfSpecimenAndModelAreTheSame) {
  const std::string file = experiment({kIdeal, kPlant, plant_arguments(), kBoth});
  ASSERT_EQ(run(file, "virtual").exit_code, 0);
  const Json report = test::json_of(out() / "report.json");
  for (const char* axis : {"long", "lat"})
    EXPECT_LT(report["axes"][axis]["numerical_difference_percent"], 0.01) << axis;
}

// Without a script, there is nothing to run again: the response of the user's own takes its place.
TEST_F(OpenSeesRun, ComparesWithAResponseOfTheUsersOwn) {
  const std::string file = experiment({kIdeal, kPlant, plant_arguments(), kBoth});
  const Rows own = own_response("plasticity");
  std::string text = "time,long,lat\n0,0,0\n";
  for (const auto& row : own) text += fmt::format("{},{},{}\n", row[0], 2e3 * row[1], 2e3 * row[2]);
  const auto reference = folder_.write("reference.csv", text);
  ASSERT_EQ(
      test::run_rths({"run", file, "--clock", "virtual", "--out", out().string(), "--set",
                      fmt::format("reference={{file=\"{}\", scale=1e-3}}", reference.string())})
          .exit_code,
      0);
  const Json report = test::json_of(out() / "report.json");
  for (const char* axis : {"long", "lat"})  // twice the response
    EXPECT_NEAR(report["axes"][axis]["numerical_difference_percent"], 100, 3) << axis;
  EXPECT_FALSE(std::filesystem::exists(out() / "numerical.csv"));
}

// The next target comes at the earliest a computing time after the specimen has reached the last.
TEST_F(OpenSeesRun, TakesTheComputingTimeOfItsModelInVirtualTime) {
  const std::string file = experiment({kMachine, kPlant, plant_arguments(), kBoth});
  const auto shortest_answer = [&](const char* modelled) {
    EXPECT_EQ(
        test::run_rths({"run", file, "--clock", "virtual", "--force", "--out", out().string(),
                        "--set", std::string{"solver.model_computing_time="} + modelled, "--set",
                        "solver.computing_time_s=0.004", "--set", "solver.computing_time_spread=0"})
            .exit_code,
        0);
    const recording::Reader reader{out() / "run.h5"};
    const auto target = edges(reader.signal("opf.newTarget"), true),
               arrived = edges(reader.signal("daq.atTarget"), true);
    std::size_t shortest = 1000;
    for (const std::size_t row : arrived) {
      const auto next = std::lower_bound(target.begin(), target.end(), row);
      if (next != target.end()) shortest = std::min(shortest, *next - row);
    }
    return shortest;
  };
  EXPECT_LE(shortest_answer("false"), 1U);
  EXPECT_GE(shortest_answer("true"), 3U);  // rows begin up to a millisecond earlier
}

// A row is a tick of the controller.
TEST_F(OpenSeesRun, KeepsTheTimeOfTheController) {
  ASSERT_EQ(run(experiment({kMachine, kPlant, plant_arguments(), kBoth}), "virtual").exit_code, 0);
  const recording::Reader reader{out() / "run.h5"};
  const auto target = reader.signal("opf.newTarget"), taken = reader.signal("daq.switchPC"),
             there = reader.signal("daq.atTarget");
  for (const bool rising : {true, false}) {
    const auto asked = edges(target, rising), answered = edges(taken, rising);
    // The first targets lie between two rows.
    ASSERT_GE(asked.size(), steps() - 10);
    for (const std::size_t row : asked) {
      const auto answer = std::lower_bound(answered.begin(), answered.end(), row);
      ASSERT_NE(answer, answered.end());
      EXPECT_LE(*answer, row + 2);
    }
  }
  const auto arrived = edges(there, true);
  ASSERT_GE(arrived.size(), steps() - 10);
  for (std::size_t i = 2; i < arrived.size(); ++i)
    EXPECT_NEAR(static_cast<double>(arrived[i] - arrived[i - 1]), 10, 1) << i;
}

// The recording does not depend on the timing of OpenSees' messages.
TEST_F(OpenSeesRun, IsTheSameEveryTimeInVirtualTime) {
  const std::string file = experiment({kMachine, kPlant, plant_arguments(), kBoth});
  std::vector<std::vector<std::vector<double>>> recorded;
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(run(file, "virtual").exit_code, 0);
    const recording::Reader reader{out() / "run.h5"};
    recorded.emplace_back();
    for (const char* signal : {"opf.newTarget", "opf.long.displ.target", "daq.lat.force.fbk",
                               "srmd.long.force.fbk", "monitor.opf.step"})
      recorded.back().push_back(reader.signal(signal));
  }
  EXPECT_EQ(recorded[0], recorded[1]);
}

TEST_F(OpenSeesRun, EndsWhenOpenSeesTakesLeave) {
  const auto finished = run(
      experiment({kIdeal, "tests/opensees/fated.py", fmt::format(R"("{}", "leave", "50")", port_)}),
      "virtual");
  EXPECT_EQ(finished.exit_code, 1) << finished.err;
  EXPECT_NE(finished.out.find("found 0.50 s, ending: completed, expected " +
                              std::to_string(duration_) + " s, ending: completed"),
            std::string::npos)
      << finished.out;
  const recording::Reader reader{out() / "run.h5"};
  EXPECT_EQ(reader.signal("monitor.opf.step").back(), 49);  // no motion in the first step
}

// The loop of many scripts: a step that does not converge is repeated in parts. OpenSees returns to
// the time before it with a trial that asks for no force: no move.
TEST_F(OpenSeesRun, IsNotConclusiveIfAStepIsRepeatedInParts) {
  duration_ = 1;
  const auto finished = run(
      experiment({kIdeal, "tests/opensees/fated.py", fmt::format(R"("{}", "halve", "50")", port_)}),
      "virtual");

  EXPECT_EQ(finished.exit_code, 1) << finished.err;
  EXPECT_NE(finished.out.find("1 go back, 4 advance it by less (parts of a step), "
                              "expected each advances it by 0.01 s"),
            std::string::npos)
      << finished.out;
}

// A script of strangers, where present.
TEST_F(OpenSeesRun, NamesTheHalvedStepsOfStrangers) {
  const auto data = test::source_tree() / "../shared/data/strangers/solver";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "SKIPPED: there is no " << data;
  const auto finished = test::Running{
      {"/usr/bin/env", "MODE=halve", "RTHS_OPENSEES_PYTHON=" + python_, test::rths_command(), "run",
       (data / "adaptive.toml").string(), "--clock", "virtual", "--no-diagnosis", "--out",
       out().string(), "--force", "--set",
       "duration_s=6"}}.wait(60);

  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  // Of the quarter steps, a row may show two at once.
  EXPECT_NE(finished.out.find(" moves, 1 go back, "), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find(" advance it by less (parts of a step), expected each advances it by "
                              "0.01 s"),
            std::string::npos)
      << finished.out;
}

TEST_F(OpenSeesRun, RefusesAScriptWithAnotherStep) {
  for (const char* step : {"0.02", "0.005"}) {
    const auto finished =
        run(experiment({kIdeal, "tests/opensees/fated.py",
                        fmt::format(R"("{}", "leave", "50", "{}")", port_, step)}),
            "virtual");
    EXPECT_EQ(finished.exit_code, 2) << finished.out;
    EXPECT_NE(finished.err.find(fmt::format("the script advances its time by {} s at its first "
                                            "move, expected 0.01 s (integration_step_s)",
                                            step)),
              std::string::npos)
        << finished.err;
    const recording::Reader reader{out() / "run.h5"};
    for (const double target : reader.signal("opf.long.displ.target")) EXPECT_EQ(target, 0);
  }
}

// A bearing that is sheared, rotated and loaded by its weight, with P-Δ moments, and with local
// axes that differ from those of the script.
TEST_F(OpenSeesRun, FeelsSixComponentsOfABearingAsItsOwn) {
  duration_ = 10;  // that of the script
  const auto ring = folder_.path() / "ring.csv", own = folder_.path() / "own.csv";
  const std::string bearing = R"([node.opf.element.bearing]
height = 0.5
shear_distance = 0.3
{}
[node.opf.element.bearing.axes]
shear_y = "-long"
shear_z = "lat"
[node.opf.element.bearing.springs]
axial = 3e9
torsion = 2e7
rotation_y = 4e8
rotation_z = 5e8
)";
  const auto difference = [&](const char* option, const std::string& more) {
    const std::string arguments =
        fmt::format(R"("{{motion}}", "ring", "{}", "{}"{})", port_, ring.string(), option);
    const auto finished = run(experiment({kIdeal, kMast, arguments, kBoth, "srmd",
                                          fmt::format(fmt::runtime(bearing), more)}),
                              "virtual");
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    if (!std::filesystem::exists(own)) {
      test::Running running{{python_, (test::source_tree() / kMast).string(),
                             (out() / "run.opf.motion.csv").string(), "own", "0", own.string()}};
      EXPECT_EQ(running.wait(60).exit_code, 0);
    }
    const Rows found = read_rows(ring), expected = read_rows(own);
    EXPECT_EQ(found.size(), 1000U);
    double worst = 0;
    for (const std::size_t column : {1U, 2U, 4U, 5U})
      worst = std::max(worst, nrmse(found, expected, column));
    return worst;
  };
  EXPECT_LT(difference("", ""), 1e-5);
  EXPECT_LT(difference(R"(, "--both-nodes")", "i_dofs = [1, 2, 3, 4, 5, 6]"), 1e-5);
  // Without P-Δ moments, the test fails.
  EXPECT_GT(difference("", "p_delta = false"), 0.01);
}

// Every laboratory, with both generations of controllers.
TEST_F(OpenSeesRun, SpeaksToEveryLaboratory) {
  struct Facility {
    const char *map, *axis;
  };
  duration_ = 1;
  int runs = 0;
  for (const auto& [map, axis] :
       {Facility{"srmd", "long"}, Facility{"sts", "8"}, Facility{"sts_gt", "1"},
        Facility{"mts469d_150", "1"}, Facility{"mts469d_gt", "yaw"}, Facility{"flextest_ucb", "1"},
        Facility{"flextest_osu", "2"}})
    for (const char* generation : {"at_target_first", "target_first"}) {
      // A laboratory has one generation, in turn, or both in long runs.
      if (++runs % 4 > 1 && !test::is_long()) continue;
      const std::string handshake = fmt::format("handshake = \"{}\"\n", generation);
      const auto finished = run(
          experiment(
              {"[node.xpc]\nadapter = \"echo\"\nstiffness_N_per_m = 2.8\n" + handshake +
                   "[node.recorder]\nadapter = \"recorder\"\n",
               "tests/opensees/oscillator.py",
               fmt::format(R"("{}", "tcp", "100", "NewmarkExplicit", "0.5")", port_), R"(["long"])",
               map, fmt::format("dofs = [\"{}\"]\ninitial_stiffness = [[2.8]]", axis), handshake},
              0.02),
          "virtual");
      ASSERT_EQ(finished.exit_code, 0) << map << ' ' << generation << finished.out << finished.err;
      std::ifstream log{out() / "run.opf.log"};
      std::vector<double> u(3);
      for (double& value : u) log >> value;
      EXPECT_NEAR(u[1], -0.00994759549, 1e-8) << map;
      EXPECT_NEAR(u[2], -0.0388868053, 1e-8) << map;
    }
}

// With friction, dead band and noise of the simulated machine.
TEST_F(OpenSeesRun, IdentifiesTheSpecimenBeforeTheTest) {
  const auto finished =
      run(experiment({kMachine, kPlant, plant_arguments(), kBoth, "srmd",
                      "dofs = [\"long\", \"lat\"]\ninitial_stiffness = \"identified\""}),
          "virtual");
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const recording::Reader reader{out() / "run.h5"};
  constexpr double kStiffness = 4.238e6 + 1.01e6 / 2.855e-3;  // [N/m]
  for (const char* axis : {"long", "lat"})
    EXPECT_NEAR(reader.signal(fmt::format("monitor.opf.bearing.{}.stiffness", axis)).back(),
                kStiffness, 0.05 * kStiffness)
        << axis;
  const Rows ring = ring_response();
  EXPECT_EQ(ring.size(), steps());
}

struct Shipped {
  const char* integrator;
  double most;  ///< difference [-]
};

class OpenSeesIntegrator : public OpenSeesRun, public testing::WithParamInterface<Shipped> {};

// The shipped frame, with its column on the ring and with OpenSees' own column.
TEST_P(OpenSeesIntegrator, FeelsAColumnOnTheRingAsItsOwn) {
  const auto examples = test::source_tree() / "examples/opensees";
  const auto ring = folder_.path() / "ring.csv", own = folder_.path() / "own.csv";
  const auto finished = test::run_rths(
      {"run", (examples / "one_bay_frame.toml").string(), "--clock", "virtual", "--out",
       out().string(), "--set", "duration_s=10", "--set",
       fmt::format("node.opf={{adapter=\"opensees\", python=\"{}\", script=\"one_bay_frame.py\", "
                   "arguments=[\"{{motion}}\", \"--port\", \"{}\", \"--response\", \"{}\", "
                   "\"--duration\", \"10\", \"--integrator\", \"{}\", \"0.8\"], "
                   "element=[{{name=\"left_column\", port={}, "
                   "dofs=[\"long\"], length_unit_m=0.0254, force_unit_N=4448.2216, "
                   "initial_stiffness=[[2.8]]}}]}}",
                   python_, port_, ring.string(), GetParam().integrator, port_)});
  // Each iterate is a move, so five moves advance the time by one step.
  const bool iterates = GetParam().most > 1e-3;
  ASSERT_EQ(finished.exit_code, iterates ? 1 : 0) << finished.out << finished.err;
  EXPECT_EQ(finished.out.find("repeat the time (iterations)") != std::string::npos, iterates)
      << finished.out;
  test::Running alone{{python_, (examples / "one_bay_frame.py").string(),
                       (out() / "run.opf.motion.csv").string(), "--column", "steel", "--integrator",
                       GetParam().integrator, "0.8", "--duration", "10", "--response",
                       own.string()}};
  ASSERT_EQ(alone.wait(60).exit_code, 0);
  const Rows found = read_rows(ring), expected = read_rows(own);
  ASSERT_EQ(found.size(), 1000U);
  ASSERT_EQ(expected.size(), found.size());
  for (const std::size_t column : {1U, 2U})
    EXPECT_LT(nrmse(found, expected, column), GetParam().most) << column;
}

// The ring rounds to float32. With an iterating integrator, the specimen moves through all
// iterates, whereas OpenSees' own element restarts each of them from the last step.
INSTANTIATE_TEST_SUITE_P(Of, OpenSeesIntegrator,
                         testing::Values(Shipped{"AlphaOS", 1e-5},
                                         Shipped{"AlphaOSGeneralized", 1e-5},
                                         Shipped{"KRAlphaExplicit", 1e-5},
                                         Shipped{"NewmarkExplicit", 1e-5},
                                         Shipped{"HHTHSFixedNumIter", 5e-3}),
                         [](const auto& shipped) { return std::string{shipped.param.integrator}; });

}  // namespace
}  // namespace rths
