// SPDX-License-Identifier: Apache-2.0
//
// The whole laboratory in virtual time, started with the command.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/recording/recording.hpp>

#include "support/diagrams.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"
#include "support/waiting.hpp"

namespace rths::launch {
namespace {

using Json = nlohmann::json;

std::string example() { return (test::source_tree() / "examples/srmd_lprb_2d.toml").string(); }

/// Runs the example in virtual time without a diagnosis. @returns the numbers of its report
Json numbers_of(const std::filesystem::path& out, const std::vector<std::string>& changes = {}) {
  std::vector<std::string> arguments{"run",   example(),   "--clock", "virtual", "--no-diagnosis",
                                     "--out", out.string()};
  for (const auto& change : changes) {
    arguments.emplace_back("--set");
    arguments.push_back(change);
  }
  const test::Finished run = test::run_rths(arguments, 120);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return Json::parse(test::content_of(out / "report.json"));
}

TEST(VirtualRun, HasThePapersTwoDimensionalFigures) {
  const test::TemporaryFolder folder;
  const Json numbers =
      numbers_of(folder.path(), {test::is_long() ? "duration_s=40" : "duration_s=20", "held_out={}",
                                 "model.specimen.lead_heating.enabled=true",
                                 "machine.load_dependent_friction.enabled=false"});

  EXPECT_EQ(numbers["clock"], "virtual");
  EXPECT_EQ(numbers["slow_downs"], 0);
  EXPECT_NEAR(numbers["predict_ms_mean"], 3, 0.5);
  EXPECT_NEAR(numbers["correct_ms_mean"], 7, 0.5);
  EXPECT_NEAR(numbers["control_rate_hz"], 1000, 0.1);
  for (const char* axis : {"long", "lat"}) {
    const Json& a = numbers["axes"][axis];
    EXPECT_GE(a["delay_raw_ms"], 55) << axis;
    EXPECT_LE(a["delay_raw_ms"], 65) << axis;
    EXPECT_GE(a["delay_raw_min_rms_ms"], 55) << axis;
    EXPECT_LE(a["delay_raw_min_rms_ms"], 65) << axis;
    EXPECT_LE(std::abs(a["delay_compensated_ms"].get<double>()), 6.5) << axis;
    EXPECT_LT(a["nrms_percent"], 1) << axis;
    // Specimen and model are equal here, so only the machine's errors make the results differ.
    EXPECT_NEAR(a["peak_shear_kN"], a["numerical_peak_shear_kN"].get<double>(),
                0.05 * a["numerical_peak_shear_kN"].get<double>())
        << axis;
    EXPECT_NEAR(a["peak_displacement_mm"], a["numerical_peak_displacement_mm"].get<double>(),
                0.2 * a["numerical_peak_displacement_mm"].get<double>())
        << axis;
  }
  for (const auto& [node, drops] : numbers["drops"].items()) EXPECT_EQ(drops, 0) << node;
}

class EveryBearing : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryBearing, BehavesInTheTestAsInTheSimulation) {
  const test::TemporaryFolder folder;
  const auto file =
      test::source_tree() / "examples" / (std::string{"srmd_"} + GetParam() + "_2d.toml");
  const test::Finished run = test::run_rths(
      {"run", file.string(), "--clock", "virtual", "--out", folder.path().string(), "--set",
       test::is_long() ? "duration_s=40" : "duration_s=15", "--set", "uncompensated={}"},
      120);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json numbers = Json::parse(test::content_of(folder.path() / "report.json"));

  for (const char* axis : {"long", "lat"}) {
    const Json& a = numbers["axes"][axis];
    EXPECT_LE(std::abs(a["delay_compensated_ms"].get<double>()), 6.5) << axis;
    EXPECT_LT(a["nrms_percent"], 1.5) << axis;
    // The closed loop amplifies the machine's errors: 4 to 12 % of the peaks.
    for (const char* peak : {"peak_displacement_mm", "peak_shear_kN"}) {
      const double computed = a[std::string{"numerical_"} + peak].get<double>();
      EXPECT_NEAR(a[peak], computed, 0.15 * computed) << axis << " " << peak;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, EveryBearing, ::testing::Values("eqsb", "tpfb"),
                         [](const auto& instance) { return std::string{instance.param}; });

TEST(VirtualRun, GivesTheSameBitsEveryTime) {
  const test::TemporaryFolder first;
  const test::TemporaryFolder second;
  const std::vector<std::string> changes{test::is_long() ? "duration_s=40" : "duration_s=4",
                                         "held_out={}"};
  static_cast<void>(numbers_of(first.path(), changes));
  static_cast<void>(numbers_of(second.path(), changes));

  for (const char* file : {"run.h5", "uncompensated.h5", "numerical.h5"}) {
    const std::string command = "h5diff --exclude-path=/meta " + (first.path() / file).string() +
                                " " + (second.path() / file).string();
    EXPECT_EQ(std::system(command.c_str()), 0) << file;
  }
}

/// RMS of the difference of a signal between two recordings, over the RMS of the first.
double difference(const recording::Reader& a, const recording::Reader& b, const std::string& name) {
  const auto first = a.signal(name);
  const auto second = b.signal(name);
  double error = 0, size = 0;
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i) {
    error += (first[i] - second[i]) * (first[i] - second[i]);
    size += first[i] * first[i];
  }
  return std::sqrt(error / size);
}

// A message needs 1 to 100 µs on the ring, and the nodes read what has arrived at their steps.
TEST(VirtualRun, HasTheSameResponseOnARingOfCards) {
  const test::TemporaryFolder shared, first, second;
  const std::string duration = test::is_long() ? "duration_s=40" : "duration_s=2";
  for (const auto* folder : {&shared, &first, &second}) {
    const std::string fidelity = folder == &shared ? "shared" : "replicated";
    static_cast<void>(numbers_of(folder->path(), {duration, "rest_s=0.2", "uncompensated={}",
                                                  "held_out={}", "fidelity=" + fidelity}));
  }

  const recording::Reader a{shared.path() / "run.h5"};
  const recording::Reader b{first.path() / "run.h5"};
  for (const char* signal : {"srmd.long.displ.fbk", "srmd.lat.displ.fbk", "srmd.long.force.fbk"})
    EXPECT_LE(difference(a, b, signal), 1e-3) << signal;
  const std::string command = "h5diff --exclude-path=/meta " + (first.path() / "run.h5").string() +
                              " " + (second.path() / "run.h5").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
}

class EveryNode : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryNode, MayLeaveTheRingOfCardsDuringARun) {
  const test::TemporaryFolder folder;
  const auto file =
      folder.write("faulty.toml", test::content_of(example()) +
                                      "\n[[fault]]\nat_s = 1\nkind = \"power_off\"\nnode = \"" +
                                      GetParam() + "\"\n");
  const test::Finished run = test::run_rths(
      {"run", file.string(), "--clock", "virtual", "--no-diagnosis", "--out",
       (folder.path() / "out").string(), "--set", "fidelity=replicated", "--set", "duration_s=3",
       "--set", "rest_s=0.2", "--set", "uncompensated={}", "--set", "held_out={}", "--set",
       "folder=" + (test::source_tree() / "examples").string()},
      60);

  EXPECT_NE(run.exit_code, 0);
  EXPECT_NE((run.out + run.err).find(std::string{GetParam()} + " out of the ring at 1.000 s"),
            std::string::npos)
      << run.out << run.err;
}

INSTANTIATE_TEST_SUITE_P(OfTheExample, EveryNode, ::testing::Values("opf", "xpc", "srmd"),
                         [](const auto& instance) { return std::string{instance.param}; });

TEST(VirtualRun, HasOtherNoiseWithAnotherSeed) {
  const test::TemporaryFolder first;
  const test::TemporaryFolder second;
  static_cast<void>(
      numbers_of(first.path(), {"duration_s=2", "seed=1", "uncompensated={}", "held_out={}"}));
  static_cast<void>(
      numbers_of(second.path(), {"duration_s=2", "seed=2", "uncompensated={}", "held_out={}"}));

  const recording::Reader a{first.path() / "run.h5"};
  const recording::Reader b{second.path() / "run.h5"};
  EXPECT_NE(a.signal("srmd.long.force.fbk"), b.signal("srmd.long.force.fbk"));
}

TEST(VirtualRun, SlowsDownWhereTheSolverOverruns) {
  const test::TemporaryFolder folder;
  const Json numbers = numbers_of(
      folder.path(), {"duration_s=10", "solver.overrun_fraction=0.1", "solver.overrun_s=0.008",
                      "node.srmd.safety.enabled=false", "uncompensated={}", "held_out={}"});

  // One step in ten takes 11 ms; targets later than 6 ms slow the command down. Where it catches
  // up, its acceleration is just beyond the machine's.
  EXPECT_GT(numbers["slow_downs"], 60);
  EXPECT_LT(numbers["slow_downs"], 150);
  EXPECT_LE(std::abs(numbers["axes"]["long"]["delay_compensated_ms"].get<double>()), 10);
}

// The report of the test is complete without its companions.
TEST(VirtualRun, HasItsReportIfTheSecondEarthquakeFails) {
  const test::TemporaryFolder folder;
  const test::Finished run = test::run_rths(
      {"run", example(), "--clock", "virtual", "--out", folder.path().string(), "--set",
       "duration_s=8", "--set", "uncompensated={}", "--set", "held_out.scale=5.9"},
      120);
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_NE(run.err.find("rths: no test under the second earthquake: "), std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find("rths: no diagnosis: "), std::string::npos) << run.err;
  EXPECT_EQ(test::json_of(folder.path() / "report.json")["conclusive"], true);

  const auto recording = (folder.path() / "run.h5").string();
  const test::Finished dump = test::run_rths({"dump", recording, "--once", "opf.newTarget"});
  EXPECT_EQ(dump.exit_code, 2);
  EXPECT_NE(dump.err.find("found --once with a recording"), std::string::npos) << dump.err;
}

class Rate : public ::testing::TestWithParam<int> {};

TEST_P(Rate, StretchesTheTestButNotTheResult) {
  const test::TemporaryFolder folder;
  const Json numbers = numbers_of(
      folder.path(),
      {"duration_s=12", "uncompensated={}", "held_out={}", "rate=" + std::to_string(GetParam())});

  EXPECT_EQ(numbers["duration_s"], 12);
  const double step_ms = 10.0 * GetParam();
  EXPECT_NEAR(numbers["predict_ms_mean"].get<double>() + numbers["correct_ms_mean"].get<double>(),
              step_ms, 0.02 * step_ms);
  const Json& axis = numbers["axes"]["lat"];
  EXPECT_NEAR(axis["peak_displacement_mm"], axis["numerical_peak_displacement_mm"].get<double>(),
              0.08 * axis["numerical_peak_displacement_mm"].get<double>());
}

INSTANTIATE_TEST_SUITE_P(Rates, Rate, ::testing::Values(1, 2, 10));

TEST(VirtualRun, TestsOneAxisAlone) {
  const test::TemporaryFolder folder;
  const Json numbers = numbers_of(
      folder.path(), {"duration_s=12", "uncompensated={}", "held_out={}", "axes=[\"lat\"]"});

  ASSERT_EQ(numbers["axes"].size(), 1U);
  EXPECT_LE(std::abs(numbers["axes"]["lat"]["delay_compensated_ms"].get<double>()), 6.5);
  const recording::Reader reader{folder.path() / "run.h5"};
  for (const double u : reader.signal("monitor.srmd.true.displ.long")) ASSERT_NEAR(u, 0, 1e-3);
}

// Solver and ideal machine exchange the only words of this test.
TEST(VirtualRun, WithoutAControllerHasAReport) {
  const test::TemporaryFolder folder;
  const auto motion = test::source_tree() / "examples/records/petrolia_1992_riodell_freefield.csv";
  const auto experiment = folder.write(
      "ideal.toml",
      "format = 1\nname = \"ideal\"\nmap = \"srmd\"\nduration_s = 8\n[motion]\nfile = \"" +
          motion.string() +
          "\"\n[node.xpc]\nadapter = \"ideal_machine\"\n[node.opf]\nadapter = "
          "\"numerical\"\n[node.recorder]\nadapter = \"recorder\"\n");

  const auto run = test::run_rths({"run", experiment.string(), "--clock", "virtual", "--out",
                                   (folder.path() / "out").string()});

  EXPECT_EQ(run.exit_code, 0) << run.err;
  const Json numbers = Json::parse(test::content_of(folder.path() / "out/report.json"));
  std::vector<std::string> left_out;
  for (const auto& left : numbers["left_out"]) left_out.push_back(left["section"]);
  EXPECT_EQ(left_out,
            (std::vector<std::string>{"compensation", "predictor-corrector", "raw delay"}));
  for (const char* axis : {"long", "lat"}) {
    const Json& a = numbers["axes"][axis];
    EXPECT_GT(a["peak_displacement_mm"], 10) << axis;
    EXPECT_LT(a["numerical_difference_percent"], 5) << axis;
    // Of each step of 10 ms, the solver computes for 3 ms. The machine arrives at the end.
    EXPECT_NEAR(a["delay_compensated_ms"].get<double>(), 7, 1) << axis;
  }
}

TEST(VirtualRun, FailsOnALoadCellOfTheWrongSign) {
  const test::TemporaryFolder folder;
  const auto run = test::run_rths(
      {"run", example(), "--clock", "virtual", "--no-diagnosis", "--out", folder.path().string(),
       "--set", "duration_s=6", "--set",
       "machine.load_cell={kind=\"gain\", channel=\"force\", axes=[\"lat\"], factor=-1}", "--set",
       "node.srmd.safety.enabled=false", "--set", "uncompensated={}", "--set", "held_out={}"},
      120);

  EXPECT_EQ(run.exit_code, 1);
  const Json numbers = Json::parse(test::content_of(folder.path() / "report.json"));
  EXPECT_EQ(numbers["conclusive"], false);
  const auto& broken = numbers["broken"];
  const auto force = std::find_if(broken.begin(), broken.end(), [](const Json& condition) {
    return condition["condition"] == "force" && condition["signal"] == "srmd.lat.force.fbk";
  });
  ASSERT_NE(force, broken.end()) << broken.dump(2);
  EXPECT_NE(run.out.find((*force)["text"].get<std::string>()), std::string::npos) << run.out;

  const auto again = test::run_rths({"report", folder.path().string()});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_EQ(Json::parse(test::content_of(folder.path() / "report.json"))["broken"], broken);
}

TEST(VirtualRun, IsRefusedWithoutASolver) {
  const test::TemporaryFolder folder;
  std::string text = test::content_of(example());
  text.erase(text.find("[node.opf]"), std::string{"[node.opf]\nadapter = \"numerical\"\n"}.size());
  for (auto at = text.find("\"records/"); at != std::string::npos; at = text.find("\"records/"))
    text.replace(at, 9, '"' + (test::source_tree() / "examples/records/").string());
  text.replace(text.find("\"srmd_constants.toml"), 1,
               '"' + (test::source_tree() / "examples/").string());
  text.erase(text.find("\n[solver]"),
             text.find("\n[", text.find("\n[solver]") + 1) - text.find("\n[solver]"));
  const auto file = folder.write("no_solver.toml", text);

  const auto run = test::run_rths(
      {"run", file.string(), "--clock", "virtual", "--out", (folder.path() / "out").string()});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("no node is a solver"), std::string::npos) << run.err;
}

TEST(VirtualRun, EndsInOrderWhenANodeFails) {
  const test::TemporaryFolder folder;
  // A controller that never raises atTarget, so that the first step cannot begin.
  const auto diagram = folder.write("mute.toml", test::zero_diagram("daq.atTarget"));
  const test::Finished run =
      test::run_rths({"run", example(), "--clock", "virtual", "--out", folder.path().string(),
                      "--set", "node.xpc.diagram=\"" + diagram.string() + "\"", "--set",
                      "node.xpc.constants=\"" + folder.write("none.toml", "").string() + "\"",
                      "--set", "uncompensated={}", "--set", "held_out={}"});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("opf: atTarget did not rise before the deadline at"), std::string::npos)
      << run.err;
  EXPECT_GT(recording::Reader{folder.path() / "run.h5"}.rows(), 1000U);
}

// The nodes come to rest, and the recording is complete up to then.
TEST(VirtualRun, EndsInOrderWhenASignalInterruptsIt) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const test::TemporaryFolder folder;
    const auto recording = folder.path() / "run.h5";
    test::Running run{{"/usr/bin/env", "--default-signal", test::rths_command(), "run", example(),
                       "--clock", "virtual", "--out", folder.path().string()}};
    ASSERT_TRUE(test::comes_true([&] { return std::filesystem::exists(recording); }));

    ASSERT_EQ(kill(run.pid(), signal), 0);
    const auto ended = run.wait();

    EXPECT_EQ(ended.exit_code, 1) << signal;
    EXPECT_NE(ended.err.find("rths: the run ended early: interrupted\n"), std::string::npos)
        << ended.err;
    EXPECT_GT(recording::Reader{recording}.rows(), 0U);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder.path()}, {}), 1) << signal;
  }
}

// No report must take half a companion for a whole one.
TEST(VirtualRun, LeavesNoHalfCompanionWhenASignalInterruptsIt) {
  const test::TemporaryFolder folder;
  const auto companion = folder.path() / "uncompensated.h5";
  test::Running run{{"/usr/bin/env", "--default-signal", test::rths_command(), "run", example(),
                     "--clock", "virtual", "--out", folder.path().string()}};
  ASSERT_TRUE(test::comes_true([&] { return std::filesystem::exists(companion); },
                               std::chrono::seconds{60}));

  ASSERT_EQ(kill(run.pid(), SIGTERM), 0);
  const auto ended = run.wait();

  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_NE(ended.err.find("rths: interrupted\n"), std::string::npos) << ended.err;
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "run.h5"));
  EXPECT_FALSE(std::filesystem::exists(companion));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / ".lock"));
}

}  // namespace
}  // namespace rths::launch
