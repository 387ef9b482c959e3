// SPDX-License-Identifier: Apache-2.0
//
// The commands before a test, on short runs of the virtual machine.
#include <cmath>
#include <csignal>
#include <filesystem>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/core/config.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/waiting.hpp"

namespace rths::commissioning {
namespace {

using Json = nlohmann::json;

std::string example(const char* name) { return (test::source_tree() / "examples" / name).string(); }

/// Arguments of a run of an example in virtual time.
std::vector<std::string> run_of(const char* name, const std::filesystem::path& out,
                                const std::vector<std::string>& sets) {
  std::vector<std::string> arguments{"run",     example(name), "--clock",
                                     "virtual", "--out",       out.string()};
  for (const auto& set : sets) {
    arguments.emplace_back("--set");
    arguments.push_back(set);
  }
  return arguments;
}

Json json_of(const std::vector<std::string>& arguments, int expected_exit = 0) {
  const auto ran = test::run_rths(arguments, 110);
  EXPECT_EQ(ran.exit_code, expected_exit) << ran.out << ran.err;
  return Json::parse(ran.out, nullptr, false);
}

std::vector<std::string> pretest_of(const std::vector<std::string>& sets,
                                    const char* name = "srmd_lprb_2d.toml") {
  std::vector<std::string> arguments{"pretest", example(name), "--json"};
  for (const auto& set : sets) {
    arguments.emplace_back("--set");
    arguments.push_back(set);
  }
  return arguments;
}

void expect_refused(const std::vector<std::string>& arguments, const std::string& text,
                    int exit_code = 2) {
  const auto ran = test::run_rths(arguments);
  EXPECT_EQ(ran.exit_code, exit_code) << ran.out;
  EXPECT_NE(ran.err.find(text), std::string::npos) << ran.err;
}

// The strong motion of the example begins after 3 s.
const std::vector<std::string> kShort{"duration_s=10", "rest_s=0.5"};

std::vector<std::string> with(std::vector<std::string> sets, const std::vector<std::string>& more) {
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}

// Constants of the machine in examples/empty_table.toml: those of docs/theory/test_machine.md.
TEST(IdentifyCommand, WritesConstantsThatTheControllerReads) {
  const test::TemporaryFolder folder;
  const auto run = folder.path() / "empty", constants = folder.path() / "force.toml";
  ASSERT_EQ(test::run_rths(run_of("empty_table.toml", run,
                                  {"targets.frequencies_Hz=[0.5, 1, 2]", "duration_s=22"}))
                .exit_code,
            0);

  const auto found =
      json_of({"identify", "empty-table", run.string(), "--json", "--out", constants.string()});

  const auto& axis = found["axes"]["long"];
  EXPECT_NEAR(axis["effective_mass_kg"]["value"].get<double>(), 113'371,
              3 * axis["effective_mass_kg"]["half_width_95"].get<double>());
  EXPECT_LT(axis["effective_mass_kg"]["half_width_95"].get<double>(), 3'000);
  EXPECT_NEAR(axis["coulomb_friction_N"]["value"].get<double>(), 5'100, 300);
  const auto& viscous = found["axes"]["lat"]["viscous_friction_N_s_per_m"];
  EXPECT_NEAR(viscous["value"].get<double>(), 870, 1.5 * viscous["half_width_95"].get<double>());
  EXPECT_GT(viscous["value"].get<double>(), 0);
  EXPECT_NEAR(axis["force_offset_N"]["value"].get<double>(), 2'000, 300);
  EXPECT_NEAR(axis["acceleration_delay_ms"]["value"].get<double>(), 0, 1);
  const auto observer = Config::load(constants).table("observer");
  EXPECT_EQ(observer.numbers("effective_mass_kg").size(), 2U);
  const auto check = test::run_rths({"check", example("empty_table.toml")});
  EXPECT_EQ(check.exit_code, 0) << check.err;
  const auto used = test::run_rths(run_of(
      "empty_table.toml", folder.path() / "again",
      {"targets.frequencies_Hz=[2]", "duration_s=4", "node.xpc.constants=" + constants.string()}));
  EXPECT_EQ(used.exit_code, 0) << used.err;
  const auto file = (run / "run.h5").string(), before = test::content_of(file);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"identify", "empty-table", file, "--out", file},
        {"calibrate", file, "--out", file}})
    expect_refused(command, "run.h5: is a recording, expected another file");
  EXPECT_TRUE(test::content_of(file) == before);
  expect_refused({"identify", "empty-table", run.string(), file}, "run.h5: is given twice");
  const auto copy = (folder.path() / "copy.h5").string();
  std::filesystem::copy_file(file, copy);
  expect_refused({"identify", "empty-table", file, copy},
                 "copy.h5: holds the same signals as " + file);
  expect_refused({"identify", "empty-table", file, "--block", "a]", "--out", constants.string()},
                 "the name is 'a]', expected letters, digits, - and _");
  expect_refused({"calibrate", file, "--feed-forward-share", "nan"}, "nan is not a number", 3);
  expect_refused({"calibrate", file, "--band-Hz", "nan", "1"}, "nan is not a number", 3);
}

TEST(IdentifyCommand, LeavesAnEarlierFileIfTheDiskIsFull) {
  const test::TemporaryFolder folder;
  const auto run = folder.path() / "empty";
  ASSERT_EQ(test::run_rths(
                run_of("empty_table.toml", run, {"targets.frequencies_Hz=[2]", "duration_s=6"}))
                .exit_code,
            0);
  const auto constants = folder.write("force.toml", "[observer]\n");
  std::filesystem::create_symlink("/dev/full", folder.path() / "force.toml.part");

  expect_refused({"identify", "empty-table", run.string(), "--out", constants.string()},
                 "force.toml: cannot be written");

  EXPECT_EQ(test::content_of(constants), "[observer]\n");
}

// The machine imposes the response of the numerical test, and the inverse learns meanwhile. Four
// standard deviations bound each coefficient; uncertainty_a1_s is 10 ms by default.
TEST(IdentifyCommand, WritesLearntCoefficientsThatTheNextRunStartsFrom) {
  const test::TemporaryFolder folder;
  const auto first = folder.path() / "first", next = folder.path() / "next";
  const auto constants = folder.path() / "inverse.toml";
  const auto sets = with(kShort, {"targets.kind=response"});
  ASSERT_EQ(test::run_rths(run_of("srmd_lprb_2d.toml", first, sets)).exit_code, 0);

  const auto learnt =
      json_of({"identify", "inverse", first.string(), "--json", "--out", constants.string()});

  const auto& velocity = learnt["axes"]["long"]["a1_s"];
  EXPECT_FLOAT_EQ(velocity["initial"].get<float>(), 0.0508F);  // recorded in 32 bits
  EXPECT_NE(velocity["learnt"], velocity["initial"]);
  EXPECT_NEAR(velocity["learnt"].get<double>(), 0.0508, 4 * 0.01);
  ASSERT_EQ(test::run_rths(run_of("srmd_lprb_2d.toml", next,
                                  with(sets, {"node.xpc.constants=" + constants.string()})))
                .exit_code,
            0);
  const auto again = json_of({"identify", "inverse", next.string(), "--json"});
  for (const char* axis : {"long", "lat"})
    for (const auto& [key, value] : again["axes"][axis].items()) {
      const double wanted = learnt["axes"][axis][key]["learnt"];
      EXPECT_NEAR(value["initial"].get<double>(), wanted, 1e-5 * std::abs(wanted)) << key;
    }
  const auto both = json_of({"identify", "inverse", first.string(), next.string(), "--json"});
  EXPECT_GT(both["axes"]["lat"]["a2_s2"]["deviation"].get<double>(), 0);
  expect_refused({"identify", "empty-table", first.string()},
                 "run.h5: is a test with a specimen, expected [machine] empty_table = true");
  const auto none = test::run_rths({"identify", "inverse", first.string(), "--block", "ats"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("no recording has a block 'ats' that learnt"), std::string::npos)
      << none.err;
}

TEST(CommandedDisplacements, RefuseWrongKeys) {
  const test::TemporaryFolder folder;
  const auto error_with = [&](const std::string& set) {
    const auto ran = test::run_rths(run_of("empty_table.toml", folder.path() / "run", {set}));
    EXPECT_EQ(ran.exit_code, 2) << set;
    return ran.err;
  };
  const auto expect = [&](const std::string& set, const std::string& text) {
    const auto error = error_with(set);
    EXPECT_NE(error.find(text), std::string::npos) << error;
  };
  expect("targets.kind=wave", "expected harmonic, sweep, noise, response or file");
  expect("targets.frequencies_Hz=[0.1, 99]", "has 99, expected 0.01 to 20");
  expect("targets={kind=\"response\"}", "motion");
  expect("targets.amplitude_m=[0.1]", "has 1 numbers, expected two");
  expect("targets.cycles=100", "the bursts take");
  expect("targets.hue=3", "unknown key 'hue'");
  const auto constants = folder.write("constants.toml", "[observr]\neffective_mass_kg = [1, 1]\n");
  expect("node.xpc.constants=" + constants.string(),
         "no block 'observr' (did you mean 'observer'?)");
}

TEST(DelayCommand, MeasuresTheMachineAndRefusesRest) {
  const test::TemporaryFolder folder;
  const auto run = folder.path() / "sweep";
  ASSERT_EQ(test::run_rths(run_of("characterisation.toml", run, {"duration_s=20"})).exit_code, 0);

  const auto found = json_of({"delay", run.string(), "--target", "reference", "--measured",
                              "machine_displacement", "--json"});
  ASSERT_EQ(found["pairs"].size(), 2U);
  const auto& whole = found["pairs"][0]["whole"];
  // 1/K + τ = 49 + 2 ms for slow motion; more with the dead band, and towards 10 Hz.
  EXPECT_GT(whole["delay_ms"].get<double>(), 45);
  EXPECT_LT(whole["delay_ms"].get<double>(), 75);
  EXPECT_FALSE(found["pairs"][0]["windows"].empty());

  const auto gains = folder.path() / "gains.toml";
  const auto calibrated = json_of({"calibrate", run.string(), "--json", "--out", gains.string()});
  const auto lag = calibrated["axes"]["long"]["a1"]["value"].get<double>();
  EXPECT_NEAR(1e3 * lag, whole["delay_ms"].get<double>(), 10);
  EXPECT_EQ(Config::load(gains).table("ats").numbers("initial").size(), 3U);

  const auto still = test::run_rths({"delay", run.string(), "--least-rms", "10"});
  EXPECT_EQ(still.exit_code, 2);
  EXPECT_NE(still.err.find("moves too little"), std::string::npos) << still.err;
  const auto unknown = test::run_rths(
      {"delay", run.string(), "--target", "no.such.signal", "--measured", "srmd.long.displ.fbk"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("no.such.signal"), std::string::npos) << unknown.err;
}

TEST(PretestCommand, NamesAForceThatFallsAsTheDisplacementRises) {
  const auto found = json_of(
      pretest_of(with(kShort, {"machine.gain.channel=force", "machine.gain.factor=-1"})), 1);
  EXPECT_FALSE(found["go"].get<bool>());
  EXPECT_NE(found["reasons"].dump().find("srmd.long.force.fbk has the opposite sign"),
            std::string::npos)
      << found["reasons"];
}

TEST(PretestCommand, NamesAFactorOfAThousand) {
  const auto found = json_of(
      pretest_of(with(kShort, {"machine.gain.channel=acceleration", "machine.gain.factor=0.001"})),
      1);
  EXPECT_NE(found["reasons"].dump().find("srmd.long.accel.fbk"), std::string::npos)
      << found["reasons"];
}

TEST(PretestCommand, NamesSwappedAxes) {
  const auto found =
      json_of(pretest_of(with(kShort, {"roles.long.machine_displacement=srmd.lat.displ.fbk",
                                       "roles.lat.machine_displacement=srmd.long.displ.fbk"})),
              1);
  EXPECT_NE(found["reasons"].dump().find("swapped axes"), std::string::npos) << found["reasons"];
}

TEST(PretestCommand, RefusesExperimentsThatItCannotRun) {
  const auto imposed = test::run_rths({"pretest", example("empty_table.toml")});
  EXPECT_EQ(imposed.exit_code, 2);
  EXPECT_NE(imposed.err.find("[targets]"), std::string::npos) << imposed.err;
  EXPECT_EQ(test::run_rths({"pretest", "/no/such/file.toml"}).exit_code, 2);
}

TEST(PretestCommand, LeavesNoFolderWhenASignalEndsIt) {
  const test::TemporaryFolder folder;
  test::Running pretest{{"/usr/bin/env", "TMPDIR=" + folder.path().string(), test::rths_command(),
                         "pretest", example("srmd_lprb_2d.toml"), "--set", "duration_s=20"}};
  ASSERT_TRUE(test::comes_true([&] { return !std::filesystem::is_empty(folder.path()); }));

  ASSERT_EQ(kill(pretest.pid(), SIGTERM), 0);
  const auto ended = pretest.wait();

  EXPECT_NE(ended.exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << ended.err;
}

TEST(PretestCommand, SaysNoGoForAMachineThatIsMadeUnstable) {
  const auto late =
      json_of(pretest_of(with(kShort, {"machine.transport_delay_s=[0.09, 0.09]"})), 1);
  EXPECT_FALSE(late["go"].get<bool>());
  const auto steep = json_of(pretest_of(with(kShort, {"machine.position_gain_per_s=[90, 90]"})), 1);
  EXPECT_FALSE(steep["go"].get<bool>());
}

// Of a machine 28 ms later than that of the experiment, whose model would close the loop well.
TEST(PretestCommand, ClosesTheLoopWithTheMachineOfTheRecording) {
  const test::TemporaryFolder folder;
  const auto late = folder.path() / "late";
  ASSERT_EQ(test::run_rths(
                run_of("srmd_platen_2d.toml", late,
                       with(kShort, {"targets.kind=response", "node.xpc.tune.inverse.enabled=0",
                                     "node.xpc.tune.target_force.enabled=0",
                                     "node.srmd.changes.transport_delay_s=0.03"})))
                .exit_code,
            0);
  auto arguments = pretest_of(with(kShort, {}), "srmd_platen_2d.toml");
  arguments.insert(arguments.end(), {"--machine", late.string()});

  const auto found = json_of(arguments, 1);

  EXPECT_EQ(found["loop_machine"], "the identified machine");
  EXPECT_NE(found["reasons"].dump().find("the closed loop did not reach its end"),
            std::string::npos)
      << found["reasons"];
}

// The identified machine has no vertical axis.
TEST(PretestCommand, KeepsTheMachineOfATestThatControlsTheVerticalForce) {
  const auto found = json_of(pretest_of({"duration_s=8", "rest_s=0.5"}, "srmd_lprb_3d.toml"));

  EXPECT_EQ(found["loop_machine"],
            "the machine of the experiment, because the test controls the vertical force");
}

TEST(PretestCommand, KeepsTheRecordingsOfAnEarlierOne) {
  for (const char* name : {"imposed.h5", "closed_loop.h5", "other.h5"}) {
    const test::TemporaryFolder folder;
    const auto earlier = folder.write(name, "earlier");
    auto arguments = pretest_of(kShort);
    arguments.insert(arguments.end(), {"--out", folder.path().string()});

    expect_refused(arguments, std::string{name} + ": exists, expected a folder without");

    EXPECT_EQ(test::content_of(earlier), "earlier");
  }
}

// The actuator of a simulated machine stands for the axis, which is identified.
TEST(PretestCommand, IdentifiesTheActuatorThatTheSimulationAssumes) {
  const auto without = json_of(pretest_of(kShort));
  const auto with_delay =
      json_of(pretest_of(with(kShort, {"model.machine.actuator_delay.delay_s=0.005"})));

  EXPECT_EQ(with_delay["axes"], without["axes"]);
}

TEST(PretestCommand, PredictsTheMeanOfRunsWithDifferentNoise) {
  const auto found = json_of(pretest_of(kShort));

  const auto& axis = found["axes"]["long"];
  const auto runs = axis["difference_percent_of_runs"].get<std::vector<double>>();
  ASSERT_EQ(runs.size(), 8U);
  EXPECT_EQ(std::set<double>(runs.begin(), runs.end()).size(), runs.size());
  EXPECT_NEAR(std::accumulate(runs.begin(), runs.end(), 0.0) / 8,
              axis["difference_percent"].get<double>(), 1e-9);
}

}  // namespace
}  // namespace rths::commissioning
