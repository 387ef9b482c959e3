// SPDX-License-Identifier: Apache-2.0
// Runs in real time with OpenSees as the solver, and their end when one process fails.
#include <signal.h>

#include <chrono>
#include <map>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/broker/ring.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"
#include "support/with_opensees.hpp"

namespace rths::launch {
namespace {

using std::chrono::milliseconds;

std::string solver(const std::string& python, std::uint16_t port) {
  return fmt::format(
      "node.opf={{adapter=\"opensees\", python=\"{}\", script=\"isolated_plant.py\", "
      "arguments=[\"{{motion}}\", \"--step\", \"{{step_s}}\", \"--duration\", "
      "\"{{duration_s}}\", \"--port\", \"{}\"], "
      "element=[{{name=\"bearing\", port={}, dofs=[\"long\", \"lat\"]}}]}}",
      python, port, port);
}

/// A run in real time on a separate ring.
class Laboratory {
 public:
  Laboratory(const std::string& python, const std::string& duration)
      : ring_{test::unique_ring("opensees")},
        removal_{ring_},
        running_{{test::rths_command(), "run",
                  (test::source_tree() / "examples/opensees/isolated_plant.toml").string(),
                  "--no-diagnosis", "--out", folder_.path().string(), "--ring", ring_, "--set",
                  "duration_s=" + duration, "--set", solver(python, test::free_port())}} {}

  // Returns the process ids of OpenSees and of each node when all are running.
  std::map<std::string, int> wait_until_moving() {
    std::map<std::string, int> pids;
    for (int check = 0; check < 2000 && pids.size() < 5; ++check) {
      std::this_thread::sleep_for(milliseconds{5});
      pids.clear();
      for (const auto& report : broker::list_rings())
        for (const auto& occupant : report.occupants)
          if (report.name == ring_ && occupant.beats > 1000) pids[occupant.node] = occupant.pid;
      if (pids.count("opf") == 0) continue;
      for (const int child : test::programs_of(pids["opf"])) pids["OpenSees"] = child;
    }
    return pids;
  }
  test::Finished wait() { return running_.wait(60); }

 private:
  test::TemporaryFolder folder_;
  std::string ring_;
  test::RingRemoval removal_;
  test::Running running_;
};

using OpenSeesWall = test::WithOpenSees<testing::TestWithParam<const char*>>;

TEST_F(OpenSeesWall, RunsInRealTime) {
  Laboratory laboratory{python_, "3"};
  const auto finished = laboratory.wait();
  // 1: a busy host made it inconclusive
  EXPECT_LE(finished.exit_code, 1) << finished.err;
  EXPECT_GE(finished.exit_code, 0);
  EXPECT_NE(finished.out.find("1499 steps, 5 processes, wall clock"), std::string::npos)
      << finished.out;
}

// At 1/200 of real time, a move takes longer than OpenSees' answer deadline.
TEST_F(OpenSeesWall, AllowsAMoveLongerThanTheAnswerDeadline) {
  const test::TemporaryFolder folder;
  const std::string ring = test::unique_ring("slow");
  const test::RingRemoval removal{ring};
  const auto port = test::free_port();
  test::Running running{
      {test::rths_command(), "run",
       (test::source_tree() / "examples/opensees/one_bay_frame.toml").string(), "--out",
       folder.path().string(), "--ring", ring, "--set", "rate=200", "--set",
       fmt::format(
           "node.opf={{adapter=\"opensees\", python=\"{}\", script=\"one_bay_frame.py\", "
           "arguments=[\"{{motion}}\", \"--duration\", \"0.03\", \"--port\", \"{}\"], "
           "answer_deadline_s=1, element=[{{name=\"left_column\", port={}, dofs=[\"long\"], "
           "initial_stiffness=[[2.8]], length_unit_m=0.0254, force_unit_N=4448.2216}}]}}",
           python_, port, port)}};
  const auto finished = running.wait(60);
  // 1: a busy host made it inconclusive
  EXPECT_LE(finished.exit_code, 1) << finished.err;
  EXPECT_GE(finished.exit_code, 0);
}

// No process polls a closed socket or stays behind, and the others come to rest.
TEST_P(OpenSeesWall, EndsWhenOneIsKilled) {
  Laboratory laboratory{python_, "30"};
  const auto pids = laboratory.wait_until_moving();
  ASSERT_EQ(pids.count(GetParam()), 1U);
  const auto begun = std::chrono::steady_clock::now();
  kill(pids.at(GetParam()), SIGKILL);

  const auto finished = laboratory.wait();

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds{4});
  EXPECT_NE(finished.err.find("rths: the run ended early: "), std::string::npos) << finished.err;
  for (const auto& [name, pid] : pids) EXPECT_FALSE(test::is_running(pid)) << name;
}

// A frozen specimen gives no feedback: the others come to rest, and OpenSees exits.
TEST_F(OpenSeesWall, EndsWhenTheMachineFreezes) {
  Laboratory laboratory{python_, "30"};
  const auto pids = laboratory.wait_until_moving();
  ASSERT_EQ(pids.count("srmd"), 1U);
  const auto begun = std::chrono::steady_clock::now();
  kill(pids.at("srmd"), SIGSTOP);

  const auto finished = laboratory.wait();

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds{10});
  EXPECT_NE(finished.err.find("rths: the run ended early: "), std::string::npos) << finished.err;
  for (const auto& [name, pid] : pids) EXPECT_FALSE(test::is_running(pid)) << name;
}

INSTANTIATE_TEST_SUITE_P(Of, OpenSeesWall, testing::Values("OpenSees", "opf", "srmd", "xpc"),
                         [](const auto& death) { return std::string{death.param}; });

}  // namespace
}  // namespace rths::launch
