// SPDX-License-Identifier: Apache-2.0
//
// Hybrid tests through FMUs: the native controller and machine as FMUs give the native test, and
// the example runs to its report.
#include <signal.h>

#include <array>
#include <cstdio>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/sha256.hpp>
#include <rths/plugin/library.hpp>

#include "plugin/native_runs.hpp"
#include "support/process.hpp"
#include "support/realtime_guard.hpp"
#include "support/waiting.hpp"
#include "test_fmu.hpp"

namespace rths::fmi {
namespace {

using experiment::Overrides;

constexpr double kControllerPhase = 0.3e-3;  // [s]

/// A native node of the example as an FMU, by the bridge from plugins.
class NativeFmu {
 public:
  NativeFmu(const test::TemporaryFolder& folder, const std::string& node)
      : node_{node}, file_{folder.path() / (node + "_fmu")} {
    const auto native = test::build_tree() / "lib/rths/librths_native.so";
    const std::string config =
        "experiment = \"" + test::example() + "\"\nnode = \"" + node + "\"\n";
    const plugin::Library library{native};
    std::array<char, 400> error{};
    void* self = library.adapter().create(config.c_str(), error.data(), error.size());
    if (self == nullptr) throw std::runtime_error{error.data()};
    std::uint32_t count = 0;
    const rths_signal* signals = library.adapter().signals(self, &count);
    const auto unpacked = test::write_fmu(folder, description_of(signals, count),
                                          test::lag_library(3, "plugin_as_fmu"), 3);
    std::filesystem::rename(unpacked, file_);
    std::filesystem::create_directory(file_ / "resources");
    std::ofstream{file_ / "resources/plugin.txt"} << native.string() << '\n' << config;
    library.adapter().destroy(self);
  }

  [[nodiscard]] Overrides as_node(const std::string& role, double phase, bool own_process) const {
    const std::string key = "node." + node_ + ".";
    return {{key + "adapter", "\"fmu\""},
            {key + "file", test::quoted(file_.string())},
            {key + "role", test::quoted(role)},
            {key + "own_process", own_process ? "true" : "false"},
            {key + "tunable", "[" + tunable_ + "]"},
            {key + "start.phase", fmt::format("{}", phase)}};
  }

 private:
  std::string description_of(const rths_signal* signals, std::uint32_t count) {
    std::string text =
        R"(<fmiModelDescription fmiVersion="3.0" modelName="bridge" instantiationToken="1">
<CoSimulation modelIdentifier="plugin_as_fmu"/><ModelVariables>
<Float64 name="phase" valueReference="100000" causality="parameter" variability="fixed" start="0"/>
)";
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto& signal = signals[i];
      const bool is_parameter = signal.direction == RTHS_PARAMETER;
      if (is_parameter)
        tunable_ += fmt::format("{}\"{}\"", tunable_.empty() ? "" : ", ", signal.name);
      const char* attributes = R"(causality="output")";
      if (is_parameter) attributes = R"(causality="parameter" variability="tunable")";
      if (signal.direction == RTHS_INPUT) attributes = R"(causality="input")";
      text +=
          fmt::format("<Float64 name=\"{}\" valueReference=\"{}\" {} unit=\"{}\" start=\"{}\"/>\n",
                      signal.name, i, attributes, signal.unit, signal.initial);
    }
    return text + "</ModelVariables></fmiModelDescription>";
  }

  std::string node_;
  std::filesystem::path file_;
  std::string tunable_;
};

// Compared until the solver ends the test: an FMU has no stop of its own.
TEST(FmuRun, OfTheNativeControllerAndMachineEqualsTheNativeRun) {
  const test::TemporaryFolder folder;
  const auto native =
      test::run_virtually(test::experiment_with(test::example(), {}), folder.path() / "native.h5");
  const auto others = test::example_in(folder);
  const NativeFmu controller{folder, "xpc"}, machine{folder, "srmd"};

  for (const bool own_process : {false, true}) {
    Overrides changes = controller.as_node("controller", kControllerPhase, own_process);
    const auto more = machine.as_node("machine", 0, own_process);
    changes.insert(changes.end(), more.begin(), more.end());
    const auto run =
        test::run_virtually(test::experiment_with(others, changes),
                            folder.path() / (own_process ? "own_process.h5" : "in_process.h5"));
    test::expect_same(native, run, own_process ? "own process" : "in process", 2);
  }
}

// Figures, not limits: the host may be busy.
TEST(FmuRun, PrintsTheCostOfATick) {
  const test::TemporaryFolder folder;
  const auto others = test::example_in(folder);
  const NativeFmu controller{folder, "xpc"};
  const auto cost = [&](const Overrides& changes) {
    return test::cost_of_controller(
        test::experiment_with(changes.empty() ? test::example() : others.string(), changes));
  };
  const std::array figures{cost({}), cost(test::as_plugin("xpc", "controller", false)),
                           cost(test::as_plugin("xpc", "controller", true)),
                           cost(controller.as_node("controller", kControllerPhase, false)),
                           cost(controller.as_node("controller", kControllerPhase, true))};

  std::printf(
      "cost per tick of the controller: native %.2f us, plugin %.2f us, in its own process "
      "%.2f us, FMU %.2f us, in its own process %.2f us\n",
      figures[0], figures[1], figures[2], figures[3], figures[4]);
  for (const double figure : figures) EXPECT_GT(figure, 0);
}

/// The machine of examples/fmu, packed as its CMakeLists.txt does.
std::filesystem::path example_machine(const test::TemporaryFolder& folder) {
  const auto example = test::source_tree() / "examples/fmu/modelDescription.xml";
  return test::pack_fmu(
      test::write_fmu(folder, test::content_of(example), test::lag_library(3, "machine"), 3));
}

test::Finished run_example(const test::TemporaryFolder& folder,
                           const std::vector<std::string>& changes) {
  std::vector<std::string> words{"run",
                                 (test::source_tree() / "examples/fmu/experiment.toml").string(),
                                 "--no-diagnosis",
                                 "--out",
                                 (folder.path() / "out").string(),
                                 "--ring",
                                 "fmu_" + folder.path().filename().string(),
                                 "--set",
                                 "node.srmd.file=\"" + example_machine(folder).string() + "\""};
  words.insert(words.end(), changes.begin(), changes.end());
  return test::run_rths(words, 100);
}

// The line and the recording say whether commands of the machine pass the safety layer.
TEST(FmuRun, OfAMachineHasASafetyLayerIfItsTableAsksForOne) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> quick{"--clock", "virtual", "--force", "--set", "duration_s=4"};
  const auto with = [&](std::vector<std::string> changes) {
    changes.insert(changes.end(), quick.begin(), quick.end());
    return run_example(folder, changes);
  };
  const auto meta = [&] { return recording::Reader{folder.path() / "out/run.h5"}.meta(); };

  const auto bare = with({});
  EXPECT_EQ(bare.err, "rths: node srmd has no safety layer: rths does not guard its commands\n");
  EXPECT_EQ(meta().at("without_safety_layer"), "srmd");

  const auto guarded = with({"--set", "node.srmd.safety={}"});
  EXPECT_EQ(guarded.err, "");
  EXPECT_EQ(meta().count("without_safety_layer"), 0U);

  const auto tripped = with({"--set", "node.srmd.safety.displacement_m=[0.005, 0.005]"});
  EXPECT_EQ(tripped.exit_code, 2);
  EXPECT_EQ(tripped.err.rfind("rths: the run ended early: srmd: safety trip at ", 0), 0U)
      << tripped.err;
  const recording::Reader recording{folder.path() / "out/run.h5"};
  for (const double reference : recording.signal("srmd.long.displ.fbk"))
    ASSERT_LE(std::abs(reference), 0.005);
}

TEST(FmuRun, OfTheExampleReachesItsReport) {
  const test::TemporaryFolder folder;
  const auto run = run_example(folder, {"--clock", "virtual"});

  EXPECT_EQ(run.exit_code, 1) << run.err;  // the specimen is a spring
  const auto report = nlohmann::json::parse(test::content_of(folder.path() / "out/report.json"));
  EXPECT_TRUE(report.at("ending").is_null()) << report.at("ending");
  // The spring of the FMU: 5 kN/mm.
  const recording::Reader recording{folder.path() / "out/run.h5"};
  const auto displacement = recording.signal("srmd.long.displ.fbk");
  const auto force = recording.signal("srmd.long.force.fbk");
  double largest = 0;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    largest = std::max(largest, std::abs(displacement[i]));
    EXPECT_NEAR(force[i], 5e6 * displacement[i], 1e-6 * 5e6);
  }
  EXPECT_GT(largest, 0.001);
}

// A row has the command of its own millisecond, which the machine received one step later. The FMU
// is linear, so the replay leads the recording by one step.
TEST(FmuRun, CanBeReplayedAndIsNamedInItsRecording) {
  const test::TemporaryFolder folder;
  const auto run =
      run_example(folder, {"--clock", "virtual", "--set", "duration_s=3", "--set", "rest_s=0"});
  const recording::Reader recording{folder.path() / "out/run.h5"};
  const auto file = folder.path() / "packed.fmu";

  const auto out = (folder.path() / "out").string();
  const auto replay = test::run_rths({"replay", file.string(), out, "--node", "srmd"});
  EXPECT_NE(test::run_rths({"replay", file.string(), out})
                .err.find("node 'xpc' of the recording is not an FMU, expected --node"),
            std::string::npos);
  ASSERT_EQ(replay.exit_code, 0) << replay.err << run.err;
  const auto displacement = recording.signal("srmd.long.displ.fbk");
  double largest_step = 0;
  for (std::size_t i = 1; i < displacement.size(); ++i)
    largest_step = std::max(largest_step, std::abs(displacement[i] - displacement[i - 1]));
  double largest = 0, difference = 1;
  const auto line = replay.out.find("srmd.long.displ.fbk");
  ASSERT_NE(line, std::string::npos) << replay.out;
  ASSERT_EQ(std::sscanf(replay.out.c_str() + line, "%*s %lf %lf", &largest, &difference), 2);
  EXPECT_GT(largest, 10 * largest_step) << replay.out;
  EXPECT_LE(difference, 1.01 * largest_step) << replay.out;

  const auto identity = Config::parse(recording.config("srmd.fmu"), "srmd.fmu");
  EXPECT_EQ(identity.text("sha256"), sha256_of(file));
  EXPECT_EQ(identity.text("instantiation_token"), "{5a5e0d2e-4a0f-4cf4-9f0e-0a6f1d0c2b77}");
  EXPECT_EQ(identity.text("fmi"), "3.0");
}

TEST(FmuRun, OfAnotherStepThanTheRowsIsNotReplayed) {
  const test::TemporaryFolder folder;
  const auto run =
      run_example(folder, {"--clock", "virtual", "--set", "duration_s=1", "--set", "rest_s=0"});
  const auto config = folder.write("node.toml", "period_s = 0.0005\n");

  const auto replay = test::run_rths({"replay", (folder.path() / "packed.fmu").string(),
                                      (folder.path() / "out").string(), "--config", config});
  EXPECT_EQ(replay.exit_code, 2) << run.err;
  EXPECT_NE(replay.err.find("the FMU has steps of 0.0005 s, expected a multiple of the recording's "
                            "rows, 0.001 s"),
            std::string::npos)
      << replay.err;
}

TEST(FmuRun, InRealTimeEndsInOrder) {
  const test::TemporaryFolder folder;
  const auto run = run_example(folder, {"--set", "duration_s=2", "--set", "rest_s=0", "--set",
                                        "node.srmd.own_process=true"});

  EXPECT_EQ(run.exit_code, 1) << run.err;
  const auto report = nlohmann::json::parse(test::content_of(folder.path() / "out/report.json"));
  EXPECT_TRUE(report.at("ending").is_null()) << report.at("ending");
}

TEST(FmuRun, EndsSafelyWhenTheFmuIsBroken) {
  const test::TemporaryFolder folder;
  const auto broken =
      test::pack_fmu(test::lag_fmu(folder, 3, "fails_step",
                                   {{"name=\"u\"", "name=\"xpc.long.displ.ref\""},
                                    {"name=\"y\"", "name=\"srmd.long.displ.fbk\""}}));
  const auto experiment = folder.write("broken.toml", R"(format = 1
name = "broken_fmu"
map = "srmd"
folder = ")" + (test::source_tree() / "examples").string() +
                                                          R"("
duration_s = 5
[motion]
file = "records/petrolia_1992_riodell_freefield.csv"
[node.srmd]
adapter = "fmu"
role = "machine"
file = ")" + broken.string() +
                                                          R"("
[node.srmd.start]
enabled = true
level = 0
[node.xpc]
adapter = "simulink_like"
diagram = "hybrid_controller"
[node.opf]
adapter = "numerical"
[node.recorder]
adapter = "recorder"
)");
  const auto run = test::run_rths({"run", experiment.string(), "--clock", "virtual",
                                   "--no-diagnosis", "--out", (folder.path() / "out").string(),
                                   "--ring", "broken_fmu_" + folder.path().filename().string()},
                                  60);

  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_NE(run.err.find("the run ended early: srmd: FMU 'packed.fmu': fmi3DoStep returned "
                         "fmi3Error: the pump is off at 0.100 s"),
            std::string::npos)
      << run.err;
  EXPECT_GT(recording::Reader{folder.path() / "out" / "run.h5"}.rows(), 90U);
}

TEST(CheckOfFmuCommand, PrintsEveryRule) {
  const test::TemporaryFolder folder;
  const auto file = test::pack_fmu(test::lag_fmu(folder, 2, "correct"));

  const auto good = test::run_rths({"check", file.string()});
  EXPECT_EQ(good.exit_code, 0) << good.out << good.err;
  EXPECT_NE(good.out.find("PASS  description  'Lag', FMI 2.0, 2 inputs, 4 outputs, 3 parameters"),
            std::string::npos)
      << good.out;
  // Sanitizers replace the heap, so that its use is not tried.
  EXPECT_NE(good.out.find(test::RealTimeGuard::supported()
                              ? "FMU, 14 of 14 rules passed, 0 failed, 0 not tried"
                              : "FMU, 13 of 14 rules passed, 0 failed, 1 not tried"),
            std::string::npos)
      << good.out;

  const auto other = test::pack_fmu(test::lag_fmu(folder, 2, "correct", {{"8c4e", "0000"}}));
  const auto bad = test::run_rths({"check", other.string()});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_NE(bad.out.find("FAIL  lifecycle    activate returned 4: fmi2Instantiate failed: wrong"),
            std::string::npos)
      << bad.out;
}

TEST(CheckOfFmuCommand, LeavesNothingWhenASignalInterruptsIt) {
  const test::TemporaryFolder folder, temporary;
  const auto file = test::pack_fmu(test::lag_fmu(folder, 2, "loops"));
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    test::Running check{{"/usr/bin/env", "--default-signal", "TMPDIR=" + temporary.path().string(),
                         test::rths_command(), "check", file.string()}};
    ASSERT_TRUE(test::comes_true([&] { return !test::children_of(check.pid()).empty(); }));
    const int trial = test::children_of(check.pid()).front();
    ASSERT_EQ(kill(check.pid(), signal), 0);
    const auto ended = check.wait();

    EXPECT_EQ(ended.exit_code, 1) << signal;
    EXPECT_EQ(ended.err, "rths: interrupted\n") << signal;
    EXPECT_TRUE(std::filesystem::is_empty(temporary.path())) << signal;
    EXPECT_FALSE(test::is_running(trial)) << signal;
  }
}

}  // namespace
}  // namespace rths::fmi
