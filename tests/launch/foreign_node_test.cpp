// SPDX-License-Identifier: Apache-2.0
//
// Nodes that are programs of the user's own, in real time: those of examples/foreign.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/broker/ring.hpp>
#include <rths/recording/recording.hpp>

#include "report/browser.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"
#include "support/waiting.hpp"

namespace rths::launch {
namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

std::string example(const std::string& name) {
  return (test::source_tree() / "examples/foreign" / name).string();
}

std::string program(const std::string& name) {
  return (test::build_tree() / "bin" / ("foreign_" + name)).string();
}

// A command for the key of an external node.
std::string command_of(const Words& words) {
  std::string list;
  for (const auto& word : words) list += (list.empty() ? "\"" : ", \"") + word + "\"";
  return "node.opf.command=[" + list + "]";
}

const Words kArguments{"{motion}", "{step_s}", "{duration_s}"};

std::string solver(const std::string& name) {
  Words words{program(name)};
  if (name == "python")
    words = {"python3", (test::source_tree() / "tests/launch/foreign_solver.py").string(),
             (test::build_tree() / "broker/scramnet/libplus.so").string(),
             (test::build_tree() / "tests/foreign/srmd_map.h").string()};
  words.insert(words.end(), kArguments.begin(), kArguments.end());
  return command_of(words);
}

/// A run of an example with changes, on a ring of its own.
class ForeignRun {
 public:
  ForeignRun(const std::string& name, const std::string& experiment, const Words& changes)
      : ring{test::unique_ring(name)},
        removal_{ring},
        running{command(folder.path().string(), ring, experiment, changes)} {}

  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return folder.path() / name;
  }
  [[nodiscard]] Json report() const { return Json::parse(test::content_of(file("report.json"))); }
  /// Process of a node after 300 rows of the recorder; 0 if there is none.
  [[nodiscard]] int process_of(const std::string& node) const {
    int process = 0;
    static_cast<void>(test::comes_true([&] {
      const auto report = broker::inspect_ring(ring);
      if (!report) return false;
      bool is_recording = false;
      for (const auto& occupant : report->occupants) {
        is_recording = is_recording || (occupant.node == "recorder" && occupant.beats > 300);
        if (occupant.node == node) process = occupant.pid;
      }
      return is_recording && process != 0;
    }));
    return process;
  }
  [[nodiscard]] bool ring_is_there() const { return broker::inspect_ring(ring).has_value(); }

  test::TemporaryFolder folder;
  std::string ring;

 private:
  static Words command(const std::string& out, const std::string& ring,
                       const std::string& experiment, const Words& changes) {
    Words words{test::rths_command(), "run", example(experiment), "--out", out, "--ring", ring};
    for (const auto& change : changes) words.insert(words.end(), {"--set", change});
    return words;
  }
  test::RingRemoval removal_;

 public:
  test::Running running;
};

// A busy host may have made the run inconclusive.
void expect_regular_end(const test::Finished& run, const Json& report) {
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(run.exit_code, report["conclusive"].get<bool>() ? 0 : 1) << run.out;
  for (const auto& broken : report["broken"]) {
    EXPECT_NE(broken["condition"], "end") << broken;
    EXPECT_NE(broken["condition"], "wire") << broken;
  }
}

Words left_out_of(const Json& report) {
  Words sections;
  for (const auto& left : report["left_out"]) sections.push_back(left["section"]);
  return sections;
}

class Solver : public ::testing::TestWithParam<const char*> {};

// Programs of the vendor's API alone, in C and in Python, and one of the C++ API.
TEST_P(Solver, OfTheUsersOwnRunsATestToItsReport) {
  ForeignRun run{std::string{"foreign_"} + GetParam(),
                 "srmd_block_2d.toml",
                 {"duration_s=2", solver(GetParam())}};

  const test::Finished finished = run.running.wait();

  const Json report = run.report();
  expect_regular_end(finished, report);
  EXPECT_EQ(report["duration_s"], 2);
  EXPECT_EQ(report["integration_steps"], 200);
  EXPECT_EQ(left_out_of(report), Words{"floor spectra"});
  EXPECT_TRUE(std::filesystem::exists(run.file("report.html")));
  EXPECT_TRUE(std::filesystem::exists(run.file("uncompensated.h5")));
  EXPECT_TRUE(std::filesystem::exists(run.file("numerical.h5")));
  EXPECT_NE(test::content_of(run.file("run.opf.log")).find("the block is at"), std::string::npos);
  EXPECT_FALSE(run.ring_is_there());
}

INSTANTIATE_TEST_SUITE_P(Programs, Solver,
                         ::testing::Values("block_scramnet", "block_rths", "python"),
                         [](const auto& name) { return std::string{name.param}; });

class Killed : public ::testing::TestWithParam<const char*> {};

TEST_P(Killed, StopsTheRunWithinTwoSecondsAndKeepsTheRecording) {
  ForeignRun run{std::string{"killed_"} + GetParam(), "srmd_block_2d.toml", {solver(GetParam())}};
  const int victim = run.process_of("opf");
  ASSERT_NE(victim, 0);

  kill(victim, SIGKILL);
  const test::Finished finished = run.running.wait();

  EXPECT_LT(finished.host_seconds, 2.0);
  EXPECT_EQ(finished.exit_code, 2);
  for (const std::string node : {"opf", "xpc", "srmd", "recorder", "rths"}) {
    const auto first = ("\n" + finished.err).find("\n" + node + ": ");
    EXPECT_NE(first, std::string::npos) << node << " reports nothing:\n" << finished.err;
    EXPECT_EQ(("\n" + finished.err).find("\n" + node + ": ", first + 1), std::string::npos)
        << finished.err;
  }
  EXPECT_NE(finished.err.find(GetParam() + std::string{" was killed by signal 9"}),
            std::string::npos)
      << finished.err;
  EXPECT_GT(recording::Reader{run.file("run.h5")}.rows(), 300U);
  EXPECT_FALSE(run.ring_is_there());
}

INSTANTIATE_TEST_SUITE_P(Programs, Killed, ::testing::Values("block_scramnet", "block_rths"),
                         [](const auto& name) { return std::string{name.param}; });

TEST(ForeignNode, StoppedIsNoticedAsSilentAndEnded) {
  ForeignRun run{
      "foreign_silent", "srmd_block_2d.toml", {solver("block_scramnet"), "node.opf.silence_s=0.5"}};
  const int victim = run.process_of("opf");
  ASSERT_NE(victim, 0);

  kill(victim, SIGSTOP);
  const test::Finished finished = run.running.wait();

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("is silent: no new value in its words for 0.5 s"), std::string::npos)
      << finished.err;
  EXPECT_FALSE(test::is_running(victim));
}

// OpenFresco's control points with one signal too few: it looks for the flags a word too early.
TEST(ForeignNode, ThatCountsOtherSignalsThanTheMapIsNamedWithTheFlagThatItMisses) {
  ForeignRun run{"foreign_miscounted",
                 "srmd_block_2d.toml",
                 {command_of({(test::build_tree() / "bin/scramnet_miscounted").string()}),
                  "node.opf.silence_s=0.5"}};

  const test::Finished finished = run.running.wait();

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("daq.switchPC is 1 at word 1060 since: a program that waits for it "
                              "looks at another word, expected control points of 35 signals to the "
                              "controller and 35 back"),
            std::string::npos)
      << finished.err;
}

TEST(ForeignNode, FailureIsReportedWithItsLastLine) {
  ForeignRun run{"foreign_failure",
                 "srmd_block_2d.toml",
                 {command_of({program("block_scramnet"), "no_such_file", "0.01", "2"})}};

  const test::Finished finished = run.running.wait();

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("foreign_block_scramnet ended with 2: no_such_file is not a motion"),
            std::string::npos)
      << finished.err;
  EXPECT_FALSE(run.ring_is_there());
}

TEST(ForeignNode, IsToldHowToJoinWhenItsUserStartsIt) {
  const Words by_hand{"duration_s=2", "node.opf.command=[]"};
  ForeignRun run{"foreign_by_hand", "srmd_block_2d.toml", by_hand};
  ASSERT_TRUE(test::comes_true([&] { return run.ring_is_there(); }));
  const auto motion = run.file("motion.csv");
  std::ofstream{motion} << "t,a,b\n0,0,0\n10,0,0\n";

  test::Running solver{{"/usr/bin/env", "RTHS_SCRAMNET_RING=" + run.ring, "RTHS_SCRAMNET_NODE=opf",
                        program("block_scramnet"), motion.string(), "0.01", "2"}};

  EXPECT_EQ(solver.wait().exit_code, 0);
  const test::Finished finished = run.running.wait();
  EXPECT_LE(finished.exit_code, 1) << finished.err;
  EXPECT_NE(finished.err.find("opf: waits 60 s for its program: start it with RTHS_SCRAMNET_RING=" +
                              run.ring + " RTHS_SCRAMNET_NODE=opf"),
            std::string::npos)
      << finished.err;
  EXPECT_EQ(run.report()["duration_s"], 2);
}

TEST(ForeignNode, MissingAtItsDeadlineEndsTheStart) {
  ForeignRun run{"foreign_missing",
                 "srmd_block_2d.toml",
                 {"node.opf.command=[]", "node.opf.connect_deadline_s=0.2"}};

  const test::Finished finished = run.running.wait();

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("no program joined the ring as node 'opf' within 0.2 s"),
            std::string::npos)
      << finished.err;
  EXPECT_FALSE(run.ring_is_there());
}

TEST(ForeignNode, HasNoVirtualTime) {
  const auto refused = test::run_rths({"run", example("srmd_block_2d.toml"), "--clock", "virtual",
                                       "--out", (test::build_tree() / "never").string()});

  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("node 'opf' is a program of its own, which has no virtual time"),
            std::string::npos)
      << refused.err;
}

// The map of another laboratory, GT cards, no controller and no machine of this project.
TEST(ForeignNode, OnAnotherLaboratorysRingHasAReport) {
  ForeignRun run{"foreign_gt", "flextest_block.toml", {"duration_s=2", solver("block_gt")}};

  const test::Finished finished = run.running.wait();

  const Json numbers = run.report();
  expect_regular_end(finished, numbers);
  // A row of the recording can miss a target.
  EXPECT_NEAR(numbers["integration_steps"].get<int>(), 200, 4);
  const Json& axis = numbers["axes"]["long"];
  EXPECT_GT(axis["peak_displacement_mm"], 1);
  // The specimen is a spring.
  EXPECT_NEAR(axis["peak_shear_kN"].get<double>(),
              axis["peak_displacement_mm"].get<double>() * 9.75, 0.1);
  EXPECT_LT(axis["nrms_percent"], 20);
  EXPECT_EQ(left_out_of(numbers), (Words{"compensation", "predictor-corrector", "raw delay",
                                         "numerical result", "floor spectra"}));
  EXPECT_NE(finished.out.find("without compensation: "), std::string::npos);
  if (!std::filesystem::exists(report::test_support::kBrowser))
    GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";
  const std::string page =
      report::test_support::rendered(run.file("report.html"), run.file("profile"));
  // A loop; displacement, delay, error; lateness of the host. A page reports errors here, too.
  EXPECT_EQ(report::test_support::body_of(page), "<body data-figures=\"5\">");
  EXPECT_NE(page.find("Left out: no block 'ats' or 'inverse' of a controller 'xpc' is recorded."),
            std::string::npos);
}

// The node that plays the machine is the program's: no layer guards it.
TEST(ForeignNode, ThatIsTheMachineIsRecordedAsUnguarded) {
  ForeignRun run{"foreign_machine",
                 "flextest_block.toml",
                 {"duration_s=1", "roles.machine=\"opf\"", solver("block_gt")}};

  const test::Finished finished = run.running.wait();

  EXPECT_EQ(finished.err, "rths: node opf has no safety layer: rths does not guard its commands\n");
  EXPECT_EQ(recording::Reader{run.file("run.h5")}.meta().at("without_safety_layer"), "opf");
  const Json scope = run.report()["scope"];
  EXPECT_TRUE(std::any_of(scope.begin(), scope.end(), [](const Json& sentence) {
    return sentence.get<std::string>().rfind("Node opf has no safety layer", 0) == 0;
  })) << scope;
}

// A relative path of the experiment, and a motion by its name.
TEST(ForeignNode, RunsFromACopyOfItsExample) {
  const test::TemporaryFolder folder;
  std::filesystem::copy_file(example("flextest_block.toml"), folder.path() / "copy.toml");
  const auto ring = test::unique_ring("foreign_copy");
  const test::RingRemoval removal{ring};

  const test::Finished run = test::Running{
      {"/bin/bash", "-c",
       "cd " + folder.path().string() + " && " + test::rths_command() +
           " run copy.toml --out out --set duration_s=1 --ring " + ring + " --set '" +
           solver("block_gt") +
           "'"}}.wait();

  EXPECT_LE(run.exit_code, 1) << run.err;
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/report.json")) << run.err;
}

TEST(ForeignNode, EndsInOrderWhenTheRunIsStopped) {
  ForeignRun run{"foreign_stop", "flextest_block.toml", {solver("block_gt")}};
  const int process = run.process_of("opf");
  ASSERT_NE(process, 0);

  const auto stopped = test::run_rths({"stop", run.ring});
  const test::Finished finished = run.running.wait();

  EXPECT_EQ(stopped.exit_code, 0) << stopped.err;
  EXPECT_EQ(finished.err, "");
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_EQ(run.report()["ending"], "stopped on request");
  // A busy host may have broken another condition before.
  EXPECT_TRUE(test::breaks(run.report(), "end")) << run.report()["broken"];
  EXPECT_FALSE(test::is_running(process));
}

// The typical fault of many processes.
TEST(ForeignNode, MustNotStoreIntoTheWordOfAnother) {
  ForeignRun run{"foreign_thief", "flextest_block.toml", {"duration_s=2", solver("block_gt")}};
  ASSERT_NE(run.process_of("opf"), 0);
  {
    auto ring = broker::Ring::attach(run.ring);
    auto thief = ring.join_plain("");
    const auto force = ring.map().entry(ring.map().signal("daq.force.fbk")).signal->offset;
    const auto word = thief.plain_memory()[force.value()];
    std::atomic<bool> ends{false};
    std::thread stealing{[&] {
      for (std::uint32_t i = 0; !ends.load(); ++i) {
        std::atomic_ref{thief.plain_memory()[force.value()]}.store(word + i);
        std::this_thread::sleep_for(std::chrono::microseconds{300});
      }
    }};
    const auto who = test::run_rths({"who", run.ring, "daq.force.fbk"});
    ends.store(true);
    stealing.join();
    EXPECT_EQ(who.exit_code, 1) << who.out;
    EXPECT_NE(who.out.find("expected stores by its owner xpc alone"), std::string::npos) << who.out;
    EXPECT_EQ(test::run_rths({"who", run.ring, "daq.force.fbk"}).exit_code, 0);
  }

  const test::Finished finished = run.running.wait();

  EXPECT_EQ(finished.exit_code, 1) << finished.err;
  EXPECT_TRUE(test::breaks(run.report(), "owner")) << run.report()["broken"];
  const std::string pid = std::to_string(getpid());
  EXPECT_NE(finished.out.find("daq.force.fbk: found "), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("a client (process " + pid + ")"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("expected stores by its owner xpc alone"), std::string::npos)
      << finished.out;
}

TEST(Stop, NamesARingWithoutARun) {
  const auto ring = test::unique_ring("no_run");
  const test::RingRemoval removal{ring};
  EXPECT_NE(test::run_rths({"stop", ring}).err.find("there is no ring"), std::string::npos);

  const auto mine = broker::Ring::create(ring, test::small_map());

  // The signal would end this process.
  EXPECT_NE(test::run_rths({"stop", ring}).err.find("has no launcher"), std::string::npos);
}

}  // namespace
}  // namespace rths::launch
