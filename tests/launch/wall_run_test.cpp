// SPDX-License-Identifier: Apache-2.0
//
// The laboratory in real time, one process per node; and its safe stop when a process dies.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/broker/ring.hpp>
#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"
#include "support/test_alone.hpp"

namespace rths::launch {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;

std::string example() { return (test::source_tree() / "examples/srmd_lprb_2d.toml").string(); }

/// A run in real time on a ring of its own.
class WallRun {
 public:
  WallRun(const std::string& name, const std::string& duration,
          const std::vector<std::string>& options = {})
      : ring{test::unique_ring(name)},
        removal_{ring},
        running{command(folder.path(), ring, duration, options)} {}

  /// Waits until every node has taken 300 steps. @returns the process id of each node and of the
  /// launcher
  std::map<std::string, int> wait_until_moving() {
    std::map<std::string, int> pids;
    for (int look = 0; look < 2000; ++look) {
      for (const auto& report : broker::list_rings()) {
        if (report.name != ring) continue;
        pids.clear();
        for (const auto& occupant : report.occupants)
          if (occupant.beats > 300) pids[occupant.node] = occupant.pid;
      }
      if (pids.size() == 4) break;
      std::this_thread::sleep_for(milliseconds{5});
    }
    pids["launcher"] = running.pid();
    return pids;
  }
  [[nodiscard]] bool ring_is_there() const {
    const auto rings = broker::list_rings();
    return std::any_of(rings.begin(), rings.end(),
                       [&](const auto& report) { return report.name == ring; });
  }
  [[nodiscard]] std::filesystem::path recording() const { return folder.path() / "run.h5"; }

  test::TemporaryFolder folder;
  std::string ring;

 private:
  static std::vector<std::string> command(const std::filesystem::path& out, const std::string& ring,
                                          const std::string& duration,
                                          const std::vector<std::string>& options) {
    std::vector<std::string> words{
        test::rths_command(), "run",    example(), "--no-diagnosis", "--out",
        out.string(),         "--ring", ring,      "--set",          "duration_s=" + duration};
    words.insert(words.end(), test::kTestAlone.begin(), test::kTestAlone.end());
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }
  test::RingRemoval removal_;

 public:
  test::Running running;
};

/// For runs that a test waits for: less time at rest before the loop is closed.
const std::vector<std::string> kShortRest{"--set", "rest_s=0.5"};

/// The run reached its end. A busy host may have made it inconclusive.
void expect_regular_end(const test::Finished& run) {
  EXPECT_GE(run.exit_code, 0);
  EXPECT_LE(run.exit_code, 1) << run.err;
  EXPECT_EQ(run.err, "");
}

TEST(WallRun, RunsEachNodeAsAProcessOfItsOwn) {
  WallRun run{"processes", "3", kShortRest};
  const auto pids = run.wait_until_moving();
  std::set<int> distinct;
  for (const auto& [node, pid] : pids) distinct.insert(pid);
  EXPECT_EQ(distinct.size(), 5U);

  const test::Finished finished = run.running.wait(60);

  EXPECT_EQ(finished.err, "");
  EXPECT_NE(finished.out.find("recording " + run.recording().string()), std::string::npos);
  EXPECT_FALSE(run.ring_is_there());
  const Json numbers = Json::parse(test::content_of(run.folder.path() / "report.json"));
  EXPECT_EQ(finished.exit_code, numbers["conclusive"].get<bool>() ? 0 : 1);
  EXPECT_EQ(numbers["processes"], 5);
  EXPECT_EQ(numbers["clock"], "wall");
  EXPECT_EQ(numbers["duration_s"], 3);
  // The rate is valid only if the host was late in at most 1 % of the steps.
  if (numbers["conclusive"].get<bool>()) {
    EXPECT_NEAR(numbers["control_rate_hz"], 1000, 1);
  }
  EXPECT_GT(numbers["host_late_max_ms"], 0);
}

// A step of controller or machine begins after its scheduled time and takes some time.
TEST(WallRun, RecordsTheTimesOfTheStepsOfControllerAndMachine) {
  WallRun run{"times", "2", kShortRest};
  expect_regular_end(run.running.wait(60));

  const recording::Reader recorded{run.recording()};
  for (const std::string node : {"srmd", "xpc"}) {
    const auto late = recorded.meta_series("late." + node);
    const auto duration = recorded.meta_series("duration." + node);
    const auto steps = recorded.signal("monitor." + node + ".host.step");
    EXPECT_EQ(late.interval, 0.001) << node;
    EXPECT_EQ(late.values.size(), duration.values.size()) << node;
    // The recorder misses some of the last steps.
    EXPECT_GE(static_cast<double>(late.values.size()), steps.back()) << node;
    EXPECT_GE(*std::min_element(late.values.begin(), late.values.end()), 0) << node;
    EXPECT_GT(*std::max_element(duration.values.begin(), duration.values.end()), 0) << node;
  }
}

const std::vector<std::string> kOnCards{"--set", "rest_s=0.5", "--set", "fidelity=replicated"};

TEST(WallRun, CompletesOnARingOfCards) {
  WallRun run{"cards", "2", kOnCards};

  expect_regular_end(run.running.wait(60));
  EXPECT_FALSE(run.ring_is_there());
}

/// A node of a run on cards, pulled out of the ring.
class PulledNode : public testing::TestWithParam<const char*> {};

TEST_P(PulledNode, BringsTheOthersToRest) {
  const std::string node = GetParam();
  WallRun run{"pulled", "60", kOnCards};
  run.wait_until_moving();

  const test::Finished fault =
      test::run_rths({"fault", run.ring, "kind=power_off", "node=" + node});
  const test::Finished finished = run.running.wait(20);

  EXPECT_EQ(fault.exit_code, 0) << fault.err;
  EXPECT_NE(finished.exit_code, 0);
  EXPECT_NE(finished.err.find(node + " out of the ring at "), std::string::npos) << finished.err;
  for (const auto& report : broker::list_rings())
    EXPECT_NE(report.name.rfind(run.ring, 0), 0U) << report.name;
  const recording::Reader recorded{run.recording()};  // can be read
  EXPECT_FALSE(recorded.signal("monitor.srmd.host.step").empty());
  const std::string report = test::content_of(run.recording().parent_path() / "report.json");
  EXPECT_NE(report.find(node + " out of the ring at "), std::string::npos) << finished.out;
}

// With --full each node; otherwise one that moves the machine, and one that only receives.
INSTANTIATE_TEST_SUITE_P(WallRun, PulledNode,
                         testing::ValuesIn(test::is_long()
                                               ? std::vector{"srmd", "xpc", "opf", "recorder"}
                                               : std::vector{"xpc", "recorder"}));

TEST(WallRun, TakesAsLongAsTheTest) {
  WallRun run{"time", "3", kShortRest};

  const test::Finished finished = run.running.wait(60);

  expect_regular_end(finished);
  // 3.5 s of rest and test, about 2 s to start, stop and report; a loaded machine needs a few more.
  EXPECT_GT(finished.seconds, 3.5);
  EXPECT_LT(finished.host_seconds, 20);
}

class Death : public ::testing::TestWithParam<const char*> {};

// After kill -9 of any process, the others end within two seconds, each with one clear line.
// Nothing remains in shared memory, and the recording can be opened.
TEST_P(Death, BringsTheOthersToRestWithinTwoSeconds) {
  WallRun run{std::string{"death_"} + GetParam(), "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);
  std::this_thread::sleep_for(milliseconds{500});

  kill(pids.at(GetParam()), SIGKILL);
  const auto killed = std::chrono::steady_clock::now();
  const auto all_ended = [&] {
    return std::none_of(pids.begin(), pids.end(),
                        [](const auto& p) { return test::is_running(p.second); });
  };
  while (!all_ended() && std::chrono::steady_clock::now() - killed < std::chrono::seconds{10})
    std::this_thread::sleep_for(milliseconds{10});
  const double took =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - killed).count();
  const test::Finished finished = run.running.wait(10);

  EXPECT_LT(took, 2.0);
  const std::string victim = GetParam();
  for (const auto& [node, pid] : pids) {
    if (node == victim) continue;
    const std::string mark = (node == "launcher" ? "rths: " : node + ": ");
    const auto first = ("\n" + finished.err).find("\n" + mark);
    EXPECT_NE(first, std::string::npos) << node << " reports nothing:\n" << finished.err;
    EXPECT_EQ(("\n" + finished.err).find("\n" + mark, first + 1), std::string::npos)
        << node << " reports more than one line:\n"
        << finished.err;
  }
  EXPECT_NE(finished.err.find(victim + " "), std::string::npos) << finished.err;
  if (victim != "launcher") {
    EXPECT_EQ(finished.exit_code, 2);
  }

  static_cast<void>(test::run_rths({"clean"}));  // other tests may leave rings, too
  EXPECT_FALSE(run.ring_is_there());
  EXPECT_GT(recording::Reader{run.recording()}.rows(), 500U);
  EXPECT_NE(test::run_rths({"check", run.recording().string()}).out.find("recording, "),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Of, Death, ::testing::Values("srmd", "xpc", "opf", "recorder", "launcher"),
                         [](const auto& victim) { return std::string{victim.param}; });

// Each node finds its memory gone, holds its last inputs and comes to rest by itself.
/// Stops processes for a while, several times.
void stall(const std::vector<int>& pids, milliseconds length, int times) {
  for (int i = 0; i < times; ++i) {
    for (const int pid : pids) kill(pid, SIGSTOP);
    std::this_thread::sleep_for(length);
    for (const int pid : pids) kill(pid, SIGCONT);
    std::this_thread::sleep_for(milliseconds{150});
  }
}

// Machine and controller skip the same steps, so neither finds that the other has stood still.
TEST(WallRun, MakesTheStepsOfMachineAndControllerInTurns) {
  WallRun run{"turns", "3", kShortRest};
  auto pids = run.wait_until_moving();
  stall({pids["srmd"]}, milliseconds{40}, 3);
  stall({pids["xpc"]}, milliseconds{40}, 3);

  expect_regular_end(run.running.wait(60));

  const recording::Reader recorded{run.recording()};
  const auto machine = recorded.signal("monitor.srmd.host.step");
  const auto controller = recorded.signal("monitor.xpc.host.step");
  const auto flag = recorded.signal("opf.newTarget");  // negative: the end
  for (std::size_t row = 0; row < machine.size() && flag[row] >= 0; ++row)
    EXPECT_LE(std::abs(machine[row] - controller[row]), 2) << row;
  for (const std::string node : {"srmd", "xpc"}) {
    const auto skipped = recorded.signal("monitor." + node + ".host.skipped");
    EXPECT_GE(*std::max_element(skipped.begin(), skipped.end()), 6 * 35) << node;
  }
}

// Rows are missing while the recorder is stopped, and the test has no conclusive result.
TEST(WallRun, IsRepeatedInVirtualTimeIfTheHostWasLate) {
  WallRun run{"repeated", "3", {"--set", "rest_s=0.5", "--clock", "auto"}};
  auto pids = run.wait_until_moving();
  stall({pids["recorder"], pids["xpc"]}, milliseconds{60}, 5);

  const test::Finished finished = run.running.wait(120);

  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_NE(finished.err.find("rths: the host could not keep real time (up to "), std::string::npos)
      << finished.err;
  EXPECT_NE(finished.out.find("real_time.h5 has that attempt"), std::string::npos);
  const Json numbers = Json::parse(test::content_of(run.folder.path() / "report.json"));
  EXPECT_EQ(numbers["clock"], "virtual");
  EXPECT_NE(numbers["real_time"], nullptr);
  EXPECT_EQ(recording::Reader{run.folder.path() / "real_time.h5"}.meta().at("clock"), "wall");
}

TEST(WallRun, ComesToRestWhenItsRingIsTruncated) {
  WallRun run{"truncated", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  std::filesystem::resize_file("/dev/shm/rths." + run.ring, 0);
  const test::Finished finished = run.running.wait(20);

  EXPECT_EQ(finished.exit_code, 2);
  for (const char* node : {"srmd", "xpc", "opf", "recorder"})
    EXPECT_NE(finished.err.find(std::string{node} + ": memory of the ring was lost"),
              std::string::npos)
        << finished.err;
  EXPECT_NE(finished.err.find("srmd: memory of the ring was lost: held 0.2 s, ramped to rest"),
            std::string::npos)
      << finished.err;
  EXPECT_FALSE(run.ring_is_there());
  EXPECT_GT(recording::Reader{run.recording()}.rows(), 200U);
}

TEST(WallRun, EndsWhenANodeFallsSilent) {
  WallRun run{"silent", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  kill(pids.at("srmd"), SIGSTOP);
  const test::Finished finished = run.running.wait(20);

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(
      finished.err.find(": srmd (process " + std::to_string(pids.at("srmd")) + ") is silent: held"),
      std::string::npos)
      << finished.err;
  EXPECT_FALSE(test::is_running(pids.at("srmd")));
  EXPECT_FALSE(run.ring_is_there());
}

/// Waits until these processes have ended, at most 10 s. @returns the time that it took [s]
double seconds_until_gone(const std::vector<int>& pids) {
  const auto begun = std::chrono::steady_clock::now();
  const auto took = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  };
  while (std::any_of(pids.begin(), pids.end(), test::is_running) && took() < 10)
    std::this_thread::sleep_for(milliseconds{10});
  return took();
}

// The nodes find a silent recorder themselves, although none of them reads its words.
TEST(WallRun, EndsWhenTheRecorderFallsSilent) {
  WallRun run{"silent_recorder", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  kill(pids.at("recorder"), SIGSTOP);
  const double took = seconds_until_gone({pids.at("srmd"), pids.at("xpc"), pids.at("opf")});
  const test::Finished finished = run.running.wait(20);

  EXPECT_LT(took, 3);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find(" is silent: held"), std::string::npos) << finished.err;
  EXPECT_FALSE(test::is_running(pids.at("recorder")));
}

TEST(WallRun, ComesToRestWhenTheLauncherFallsSilent) {
  WallRun run{"silent_launcher", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  kill(pids.at("launcher"), SIGSTOP);
  const double took =
      seconds_until_gone({pids.at("srmd"), pids.at("xpc"), pids.at("opf"), pids.at("recorder")});
  kill(pids.at("launcher"), SIGCONT);
  const test::Finished finished = run.running.wait(20);

  EXPECT_LT(took, 3);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("srmd: the launcher is silent: held"), std::string::npos)
      << finished.err;
}

// The node resumes, but the run still ends and is not reported as completed.
TEST(WallRun, IsNotCompletedWhenANodeWasSilentForAWhile) {
  WallRun run{"silent_a_while", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  kill(pids.at("srmd"), SIGSTOP);
  std::this_thread::sleep_for(milliseconds{800});
  kill(pids.at("srmd"), SIGCONT);
  const test::Finished finished = run.running.wait(20);

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("rths: the run ended early: "), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find(") is silent"), std::string::npos) << finished.err;
  EXPECT_FALSE(std::filesystem::exists(run.folder.path() / "report.html"));
}

// Each node detects the fault itself: all come to rest without the launcher.
TEST(WallRun, ComesToRestThoughTheLauncherHangs) {
  WallRun run{"hanging", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  kill(pids.at("launcher"), SIGSTOP);
  kill(pids.at("srmd"), SIGKILL);
  const auto begun = std::chrono::steady_clock::now();
  const auto any_left = [&] {
    return test::is_running(pids.at("xpc")) || test::is_running(pids.at("opf")) ||
           test::is_running(pids.at("recorder"));
  };
  while (any_left() && std::chrono::steady_clock::now() - begun < std::chrono::seconds{10})
    std::this_thread::sleep_for(milliseconds{10});

  EXPECT_FALSE(any_left());
  kill(pids.at("launcher"), SIGCONT);
  EXPECT_EQ(run.running.wait(10).exit_code, 2);
}

// An operator node that leaves without notice does not stop the run.
TEST(WallRun, DoesNotDependOnATuningNode) {
  WallRun run{"operator", "3", kShortRest};
  ASSERT_EQ(run.wait_until_moving().size(), 5U);
  {
    broker::Ring ring = broker::Ring::attach(run.ring);
    const broker::Node hand = ring.join("operator", 0);
    std::this_thread::sleep_for(milliseconds{900});
  }

  expect_regular_end(run.running.wait(30));
}

// A node ignores a NaN on the ring and still ends in order.
TEST(WallRun, EndsInOrderDespiteANan) {
  WallRun run{"nan", "3", kShortRest};
  ASSERT_EQ(run.wait_until_moving().size(), 5U);
  {
    broker::Ring ring = broker::Ring::attach(run.ring);
    broker::Node hand = ring.join("operator", 0);
    const auto& map = ring.map();
    const auto& load = map.entry(map.signal("tune.xpc.compression.value"));
    ASSERT_EQ(hand.write(load.signal->offset, 0x7FC0'0000U), Status::Ok);  // a quiet NaN
  }

  const test::Finished finished = run.running.wait(30);
  expect_regular_end(finished);
  EXPECT_NE(finished.out.find("monitor.xpc.host.stale: found"), std::string::npos) << finished.out;
}

class Signal : public ::testing::TestWithParam<int> {};

// A closing terminal or a stopping service manager signals all processes of a run at once.
TEST_P(Signal, BringsTheWholeGroupToRest) {
  WallRun run{"signal_" + std::to_string(GetParam()), "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  for (const auto& [node, pid] : pids) kill(pid, GetParam());
  const test::Finished finished = run.running.wait(10);

  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_NE(finished.err.find("rths: the run ended early: interrupted"), std::string::npos);
  EXPECT_FALSE(run.ring_is_there());
  const recording::Reader reader{run.recording()};
  EXPECT_NEAR(reader.signal("xpc.long.displ.ref").back(), 0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(ToAll, Signal, ::testing::Values(SIGTERM, SIGHUP), [](const auto& signal) {
  return signal.param == SIGTERM ? "Term" : "Hup";
});

TEST(WallRun, TakesAsLongToStopAsConfigured) {
  const test::TemporaryFolder folder;
  const std::string ring = test::unique_ring("slow_rest");
  const test::RingRemoval removal{ring};

  const auto run =
      test::run_rths({"run", example(), "--no-diagnosis", "--out", folder.path().string(), "--ring",
                      ring, "--set", "duration_s=2", "--set", "uncompensated={}", "--set",
                      "held_out={}", "--set", "rest_s=0.5", "--set", "stop.ramp_s=3"});

  expect_regular_end(run);
}

TEST(WallRun, ComesToRestWhenInterrupted) {
  WallRun run{"interrupt", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  kill(pids.at("launcher"), SIGINT);
  const test::Finished finished = run.running.wait(10);

  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_NE(finished.err.find("rths: the run ended early: interrupted"), std::string::npos);
  EXPECT_FALSE(run.ring_is_there());
  // The machine is back at its initial position.
  const recording::Reader reader{run.recording()};
  EXPECT_NEAR(reader.signal("srmd.long.displ.fbk").back(), 0, 0.01);
}

// The report of a run that a person changed and then interrupted.
TEST(WallRun, IsReportedWithItsEndingAndTheOperatorsChange) {
  WallRun run{"report", "30", kShortRest};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);
  std::this_thread::sleep_for(milliseconds{1500});
  ASSERT_EQ(test::run_rths({"send", run.ring, "tune.xpc.target_force.enabled=0"}).exit_code, 0);
  std::this_thread::sleep_for(milliseconds{500});
  kill(pids.at("launcher"), SIGINT);
  EXPECT_EQ(run.running.wait(10).exit_code, 1);

  const auto report = test::run_rths({"report", run.folder.path().string()});

  EXPECT_NE(report.out.find("5 processes, wall clock"), std::string::npos) << report.out;
  EXPECT_NE(report.out.find("of 30 s: interrupted"), std::string::npos) << report.out;
  EXPECT_NE(report.out.find("changed tune.xpc.target_force.enabled from 1 to 0 at "),
            std::string::npos)
      << report.out;
  const Json numbers = Json::parse(test::content_of(run.folder.path() / "report.json"));
  EXPECT_EQ(numbers["conclusive"], false);
  EXPECT_EQ(numbers["ending"], "interrupted");
  EXPECT_EQ(numbers["processes"], 5);
  EXPECT_EQ(numbers["operator_changes"].size(), 1U);
  EXPECT_GT(numbers["host_late_max_ms"], 0);
}

TEST(WallRun, SaysInRecordingAndReportThatTheOperatorStoppedTheMachine) {
  WallRun run{"stop_word", "30", kShortRest};
  ASSERT_EQ(run.wait_until_moving().size(), 5U);
  ASSERT_EQ(test::run_rths({"send", run.ring, "tune.srmd.safety.stop=1"}).exit_code, 0);

  const test::Finished finished = run.running.wait(10);

  const std::string line = "srmd: stopped by the operator at ";
  EXPECT_EQ(finished.exit_code, 2);
  // A late host is told before.
  const auto early = finished.err.find("rths: the run ended early: ");
  EXPECT_NE(early, std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find(line, early), std::string::npos) << finished.err;
  EXPECT_NE(finished.out.find("report    "), std::string::npos) << finished.out;
  EXPECT_EQ(recording::Reader{run.recording()}.meta().at("ending").rfind(line, 0), 0U);
  const Json numbers = Json::parse(test::content_of(run.folder.path() / "report.json"));
  EXPECT_EQ(numbers["ending"].get<std::string>().rfind(line, 0), 0U) << numbers["ending"];
  EXPECT_EQ(numbers["conclusive"], false);
  ASSERT_FALSE(numbers["safety"].empty());
  EXPECT_EQ(numbers["safety"].back()["state"], "off");
  const auto& broken = numbers["broken"];
  EXPECT_TRUE(std::any_of(broken.begin(), broken.end(), [](const auto& condition) {
    return condition["found"] == "a stop by the operator";
  })) << broken;
  EXPECT_NE(test::content_of(run.folder.path() / "report.html").find(line), std::string::npos);
}

TEST(WallRun, IsNotDisturbedByASecondRunThatIsRefused) {
  WallRun run{"shared", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);
  const auto second = [&](const std::filesystem::path& out) {
    return test::run_rths(
        {"run", example(), "--no-diagnosis", "--out", out.string(), "--force", "--ring", run.ring});
  };
  const test::TemporaryFolder other;
  other.write("report.json", "of an earlier run");

  const test::Finished same_folder = second(run.folder.path());
  const test::Finished same_ring = second(other.path());

  EXPECT_EQ(same_folder.exit_code, 2);
  EXPECT_EQ(same_folder.err, "rths: " + run.folder.path().string() + ": is in use by process " +
                                 std::to_string(pids.at("launcher")) +
                                 ", expected a folder that no process writes to\n");
  EXPECT_EQ(same_ring.exit_code, 2);
  EXPECT_NE(same_ring.err.find("ring '" + run.ring + "' is in use by"), std::string::npos);
  EXPECT_EQ(test::content_of(other.path() / "report.json"), "of an earlier run");
  kill(pids.at("launcher"), SIGINT);
  EXPECT_EQ(run.running.wait(10).exit_code, 1);
  EXPECT_GT(recording::Reader{run.recording()}.rows(), 500U);
}

TEST(WallRun, FailsIfItsRecordingIsRemoved) {
  WallRun run{"removed", "30"};
  ASSERT_EQ(run.wait_until_moving().size(), 5U);

  std::filesystem::remove(run.recording());
  const test::Finished finished = run.running.wait(20);

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("rths: the run ended early: recorder: " + run.recording().string() +
                              ": was removed or replaced while it was written"),
            std::string::npos)
      << finished.err;
}

TEST(WallRun, ShowsAndTakesWordsByNameWhileItRuns) {
  WallRun run{"words", "30"};
  const auto pids = run.wait_until_moving();
  ASSERT_EQ(pids.size(), 5U);

  const auto moving =
      test::run_rths({"dump", run.ring, "srmd.*.displ.fbk", "-n", "5", "-T", "2000"});
  EXPECT_EQ(moving.exit_code, 0);
  EXPECT_EQ(std::count(moving.out.begin(), moving.out.end(), '\n'), 5);
  EXPECT_EQ(test::run_rths({"send", run.ring, "tune.xpc.compression.value=9700kN"}).exit_code, 0);
  const auto tuned = test::run_rths({"dump", run.ring, "--once", "tune.xpc.compression.value"});
  EXPECT_NE(tuned.out.find("compression.value = 9700000"), std::string::npos) << tuned.out;
  const auto who = test::run_rths({"who", run.ring, "srmd.long.displ.fbk", "opf.7.time.target"});
  EXPECT_NE(who.out.find(": by srmd, "), std::string::npos) << who.out;
  EXPECT_NE(who.out.find(": belongs to opf, "), std::string::npos) << who.out;
  EXPECT_NE(test::run_rths({"doctor"}).out.find(run.ring + ": "), std::string::npos);
  EXPECT_NE(test::run_rths({"send", run.ring, "xpc.long.displ.ref=1mm"})
                .err.find("node 'xpc' is already on the ring"),
            std::string::npos);
  static_cast<void>(test::run_rths({"clean"}));  // other tests may leave rings, too
  EXPECT_TRUE(run.ring_is_there());              // in use

  kill(pids.at("launcher"), SIGINT);
  static_cast<void>(run.running.wait(10));
  const auto events = recording::Reader{run.recording()}.events();
  EXPECT_TRUE(std::any_of(events.begin(), events.end(), [](const auto& event) {
    return event.signal == "tune.xpc.compression.value";
  }));
}

}  // namespace
}  // namespace rths::launch
