// SPDX-License-Identifier: Apache-2.0
// OpenSees on several processors: one answer, and one end for all ranks.
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "opensees_run.hpp"
#include "support/opensees.hpp"
#include "support/waiting.hpp"

namespace rths {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBricks = "examples/opensees/brick_plant.py";
constexpr const char* kFated = "tests/opensees/fated_ranks.py";
constexpr const char* kTwo = "processes = 2";

class OpenSeesRanks : public OpenSeesRun {
 protected:
  void SetUp() override {
    OpenSeesRun::SetUp();
    if (!IsSkipped() && !test::has_mpich()) GTEST_SKIP() << test::kWithoutMpich;
  }

  [[nodiscard]] std::string fated(const std::string& fate, const std::string& more = "") const {
    return experiment({kIdeal, kFated, fmt::format(R"("{}", "{}", "20"{})", port_, fate, more),
                       R"(["long"])", "srmd", "", kTwo});
  }

  // Launcher, its proxies and all ranks: processes with the script, or that the launcher has
  // started.
  [[nodiscard]] std::vector<int> left() const {
    std::vector<int> found;
    std::error_code ended;
    const std::string word = fmt::format("fated_ranks.py {} ", port_);
    for (const auto& entry : fs::directory_iterator{"/proc", ended}) {
      const int pid = std::atoi(entry.path().filename().c_str());
      if (pid > 0 && test::is_running(pid) &&
          test::command_line_of(pid).find(word) != std::string::npos &&
          !test::command_line_of(pid).starts_with(test::rths_command()))
        found.push_back(pid);
    }
    return found;
  }
  [[nodiscard]] bool nothing_is_left() const {
    return test::comes_true([&] { return left().empty(); });
  }
  // MPICH's shared memory.
  [[nodiscard]] static std::size_t segments() {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator{"/dev/shm"})
      count += entry.path().filename().string().find("mpich") != std::string::npos ? 1 : 0;
    return count;
  }

  // Runs with two ranks until these move, in the background.
  [[nodiscard]] std::unique_ptr<test::Running> moving() {
    const auto mark = folder_.path() / "moving";
    auto laboratory = std::make_unique<test::Running>(std::vector<std::string>{
        test::rths_command(), "run", fated("leave", fmt::format(R"(, "{}")", mark.string())),
        "--clock", "virtual", "--out", out().string(), "--set", "duration_s=10000"});
    EXPECT_TRUE(test::comes_true([&] { return fs::exists(mark); }, std::chrono::seconds{60}));
    return laboratory;
  }
};

// The same equations in another order: rounding.
TEST_F(OpenSeesRanks, GiveTheResponseOfOne) {
  duration_ = 2;
  Rows responses[2];
  for (const int processes : {1, 2}) {
    const auto finished =
        run(experiment({kIdeal, kBricks, plant_arguments() + R"(, "--step", "0.01")", kBoth, "srmd",
                        "", fmt::format("processes = {}", processes)}),
            "virtual");
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    responses[processes - 1] = ring_response();
  }
  ASSERT_EQ(responses[0].size(), steps());
  ASSERT_EQ(responses[1].size(), steps());
  for (std::size_t column = 1; column <= 2; ++column) {
    double peak = 0, difference = 0;
    for (std::size_t i = 0; i < steps(); ++i) {
      peak = std::max(peak, std::abs(responses[0][i][column]));
      difference =
          std::max(difference, std::abs(responses[1][i][column] - responses[0][i][column]));
    }
    EXPECT_GT(peak, 1e-3) << column;
    EXPECT_LT(difference, 1e-12 * peak) << column;
    RecordProperty(fmt::format("difference_over_peak_{}", column),
                   fmt::format("{:.2g}", difference / peak));
  }
}

struct RankFate {
  const char* name;
  const char* message;
};

TEST_F(OpenSeesRanks, EndTogetherWhateverBecomesOfOne) {
  const auto before = segments();
  for (const RankFate& fate :
       {RankFate{"kill", "rank 1 was killed by signal 9"},
        RankFate{"behead", "rank 0 was killed by signal 9"},
        RankFate{"fail", "rank 1: RuntimeError: there is no more ground to shake"},
        RankFate{"vanish", "rank 1 left its script before the end"},
        RankFate{"freeze", ": rank 1 is stopped by a signal, expected all ranks to step"},
        RankFate{"late",
                 ": rank 1 sleeps and has not begun to analyze, expected all ranks to step"},
        RankFate{"loop", ": rank 1 has not begun to analyze, expected all ranks to step"},
        RankFate{"twice",
                 "rank 0: the nodes of all ranks have a mass of 4e+06, expected 3e+06, that "
                 "of distinct nodes: node 1, for one, has a mass on the ranks 0, 1"},
        RankFate{"bearings", "rank 1: an element genericClient, expected on rank 0 alone"}}) {
    const auto finished = run(fated(fate.name), "virtual");

    EXPECT_EQ(finished.exit_code, 2) << fate.name;
    EXPECT_NE(finished.err.find(fate.message), std::string::npos)
        << fate.name << ": " << finished.err;
    EXPECT_LT(finished.host_seconds, 15) << fate.name;
    EXPECT_TRUE(nothing_is_left()) << fate.name;
  }
  EXPECT_EQ(segments(), before);
}

TEST_F(OpenSeesRanks, EndWithARunThatIsKilled) {
  const auto laboratory = moving();
  EXPECT_GE(left().size(), 4U);

  kill(laboratory->pid(), SIGKILL);

  EXPECT_TRUE(nothing_is_left());
}

TEST_F(OpenSeesRanks, EndWithARunThatIsInterrupted) {
  const auto laboratory = moving();

  kill(laboratory->pid(), SIGINT);

  static_cast<void>(laboratory->wait());
  EXPECT_TRUE(left().empty());
}

TEST_F(OpenSeesRanks, EndWithTheirLauncher) {
  const auto laboratory = moving();
  const auto all = left();
  const auto launcher = std::find_if(all.begin(), all.end(), [](int pid) {
    return test::command_line_of(pid).starts_with("mpiexec.mpich");
  });
  ASSERT_NE(launcher, all.end());

  kill(*launcher, SIGKILL);

  const auto finished = laboratory->wait();
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("fated_ranks.py was killed by signal 9"), std::string::npos)
      << finished.err;
  EXPECT_TRUE(nothing_is_left());
}

// Ranks of Open MPI's launcher, or of any other, do not see each other.
TEST_F(OpenSeesRanks, RefuseALauncherThatLeavesThemAlone) {
  const auto launcher = folder_.write("mpiexec.mpich",
                                      "#!/bin/sh\nshift 2\n\"$@\" & \"$@\"\nstatus=$?\nwait\n"
                                      "exit $status\n");
  fs::permissions(launcher, fs::perms::owner_all);
  test::Running laboratory{
      {"/usr/bin/env",
       fmt::format("PATH={}:{}", launcher.parent_path().string(), std::getenv("PATH")),
       test::rths_command(), "run", fated("leave"), "--clock", "virtual", "--out", out().string()}};

  const auto finished = laboratory.wait();

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("rank 0: getNP() is 1, expected 2: openseespy contains MPICH, whose "
                              "ranks only mpiexec.mpich brings together; those of Open MPI"),
            std::string::npos)
      << finished.err;
  EXPECT_TRUE(nothing_is_left());
}

using OpenSeesWithoutMpich = OpenSeesRun;

TEST_F(OpenSeesWithoutMpich, SaysWhatProcessesNeed) {
  test::Running laboratory{
      {"/usr/bin/env", fmt::format("PATH={}", folder_.path().string()), test::rths_command(), "run",
       experiment({kIdeal, kFated, fmt::format(R"("{}", "leave", "20")", port_), R"(["long"])",
                   "srmd", "", kTwo}),
       "--clock", "virtual", "--out", out().string()}};

  const auto finished = laboratory.wait();

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(
      finished.err.find("there is no program 'mpiexec.mpich' for processes = 2, expected that "
                        "of the Debian package mpich"),
      std::string::npos)
      << finished.err;
}

}  // namespace
}  // namespace rths
