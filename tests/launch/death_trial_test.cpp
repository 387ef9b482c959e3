// SPDX-License-Identifier: Apache-2.0
//
// Deaths and stops of the processes of a run at random moments: while it starts, runs and ends.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/broker/ring.hpp>
#include <rths/recording/recording.hpp>

#include "launch/recorded_times.hpp"
#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths::launch {
namespace {

using std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr double kRestAfterDeath = 2, kRestAfterStop = 3;  // [s]
// A stop that may pass unnoticed: the longest silence and a few looks [s].
constexpr double kLauncherUnnoticed = 1.3, kNodeUnnoticed = 0.8;
constexpr double kNodesEnd = 3.4, kLauncherEnds = 4.5;  // of an undisturbed run [s]

double since(steady_clock::time_point begun) {
  return Seconds{steady_clock::now() - begun}.count();
}

/// Process ids of the nodes on a ring, from the command lines of all processes.
std::map<std::string, int> nodes_on(const std::string& ring) {
  std::map<std::string, int> nodes;
  for (const auto& entry : std::filesystem::directory_iterator{"/proc"}) {
    const int pid = std::atoi(entry.path().filename().c_str());
    if (pid == 0) continue;
    const std::string line = test::command_line_of(pid);
    const auto name = line.find(" --node ");
    if (name == std::string::npos || line.find(" --ring " + ring + " ") == std::string::npos)
      continue;
    const auto begin = name + 8;
    nodes[line.substr(begin, line.find(' ', begin) - begin)] = pid;
  }
  return nodes;
}

/// The most beats of a node on a ring; 0 if no node has begun to step.
std::uint64_t steps_on(const std::string& ring) {
  std::uint64_t most = 0;
  if (const auto report = broker::inspect_ring(ring))
    for (const auto& occupant : report->occupants)
      if (occupant.alive) most = std::max(most, occupant.beats);
  return most;
}

/// One death or stop of one process.
struct Blow {
  std::string role;
  double moment = 0;           ///< since the start of the command [s]
  std::optional<double> stop;  ///< duration; a death without it [s]

  [[nodiscard]] std::string text() const {
    return fmt::format("{} {} at {:.3f} s", role,
                       stop ? fmt::format("stopped for {:.2f} s", *stop) : "killed", moment);
  }
};

struct Tally {
  int kills = 0, stops = 0;
  int unstarted = 0, safe = 0, completed = 0;
  double slowest_after_death = 0, slowest_after_stop = 0;  ///< [s]
  long rows_missing = 0, wrong_times = 0, compared = 0;
  int absent = 0, broken = 0, orphans = 0, rings = 0;
  std::string failures;
};

/// A short run that receives one blow.
class Trial {
 public:
  Trial(const Blow& blow, Tally& tally)
      : blow_{blow},
        tally_{tally},
        ring_{test::unique_ring("trial_" + blow.role)},
        removal_{ring_},
        running_{{test::rths_command(), "run",
                  (test::source_tree() / "examples/srmd_lprb_2d.toml").string(), "--no-diagnosis",
                  "--out", folder_.path().string(), "--ring", ring_, "--set", "duration_s=1",
                  "--set", "rest_s=0.5", "--set", "uncompensated={}", "--set", "held_out={}"}} {}
  ~Trial() {
    for (const auto& [node, pid] : nodes_on(ring_)) kill(pid, SIGKILL);
  }
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;

  /// @returns false if the process had ended before its moment
  bool run() {
    const auto victim = strike();
    if (!victim) return false;
    ++(blow_.stop ? tally_.stops : tally_.kills);
    const bool moved = steps_on(ring_) > 0;
    const bool rests = wait_for_rest();
    if (blow_.stop) {
      std::this_thread::sleep_until(struck_ + Seconds{*blow_.stop});
      if (*victim == victim_now()) kill(*victim, SIGCONT);
    }
    finished_ = running_.wait(30);
    wait_for_nodes();
    judge_end(rests);
    judge_recording(moved);
    judge_leftovers();
    return true;
  }

 private:
  void fail(const std::string& reason) {
    tally_.failures += fmt::format("{}: {}\n{}", blow_.text(), reason, finished_.err);
  }

  [[nodiscard]] std::optional<int> victim_now() const {
    if (blow_.role == "launcher")
      return test::is_running(running_.pid()) ? std::optional{running_.pid()} : std::nullopt;
    const auto nodes = nodes_on(ring_);
    const auto found = nodes.find(blow_.role);
    return found == nodes.end() ? std::nullopt : std::optional{found->second};
  }

  // Kills or stops the process at its moment, or as soon as it exists.
  std::optional<int> strike() {
    std::this_thread::sleep_until(begun_ + Seconds{blow_.moment});
    while (test::is_running(running_.pid())) {
      const auto victim = victim_now();
      const bool has_ended = !victim && steps_on(ring_) > 0;
      if (has_ended) return std::nullopt;
      if (victim && kill(*victim, blow_.stop ? SIGSTOP : SIGKILL) == 0) {
        struck_ = steady_clock::now();
        return victim;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds{2});
    }
    return std::nullopt;
  }

  // The others rest when their processes have ended, or as long as none has begun to step.
  // @returns false if they did not within the limit
  bool wait_for_rest() {
    const double limit = blow_.stop ? kRestAfterStop : kRestAfterDeath;
    for (;;) {
      const double took = since(struck_);
      auto others = nodes_on(ring_);
      others.erase(blow_.role);
      if (others.empty()) {
        double& slowest = blow_.stop ? tally_.slowest_after_stop : tally_.slowest_after_death;
        slowest = std::max(slowest, took);
        return true;
      }
      if (took > limit) {
        const bool unstarted = steps_on(ring_) == 0;
        tally_.unstarted += unstarted ? 1 : 0;
        return unstarted;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
  }

  void wait_for_nodes() const {
    const auto begun = steady_clock::now();
    while (!nodes_on(ring_).empty() && since(begun) < 5)
      std::this_thread::sleep_for(std::chrono::milliseconds{10});
  }

  // A run that went on after a stop was disturbed: it may be complete and not conclusive.
  [[nodiscard]] bool is_complete() const {
    return finished_.exit_code == 0 || (blow_.stop && finished_.exit_code == 1);
  }

  void judge_end(bool rests) {
    const bool completed = is_complete();
    ++(completed ? tally_.completed : tally_.safe);
    const bool may_pass = blow_.stop && *blow_.stop < (blow_.role == "launcher" ? kLauncherUnnoticed
                                                                                : kNodeUnnoticed);
    if (!rests && !(may_pass && completed)) fail("the others did not come to rest in time");
    const bool killed_launcher = blow_.role == "launcher" && !blow_.stop;
    if (!completed && finished_.exit_code != 2 && !killed_launcher)
      fail(fmt::format("the launcher ended with {}, signal {}", finished_.exit_code,
                       finished_.signal));
  }

  void judge_recording(bool moved) {
    const auto file = folder_.path() / "run.h5";
    if (!std::filesystem::exists(file)) {
      ++tally_.absent;
      if (moved) fail("there is no recording");
      return;
    }
    const auto check = test::run_rths({"check", file.string()});
    if (check.exit_code != 0) {
      ++tally_.broken;
      return fail("the recording does not open: " + check.err);
    }
    test::RecordedTimes times;
    const std::string error = test::error_of([&] { times = test::recorded_times(file); });
    if (!error.empty()) fail("the recording does not read: " + error);
    tally_.compared += times.compared;
    tally_.wrong_times += times.wrong;
    if (times.wrong > 0) fail(fmt::format("{} rows have a wrong time", times.wrong));
    if (is_complete()) judge_count(file, times.gaps);
  }

  // A completed run counts its missing rows.
  void judge_count(const std::filesystem::path& file, long gaps) {
    const auto missing = recording::Reader{file}.rows_missing();
    tally_.rows_missing += missing;
    if (missing < gaps) fail(fmt::format("{} rows missing, {} counted", gaps, missing));
    const auto numbers =
        nlohmann::json::parse(test::content_of(folder_.path() / "report.json"), nullptr, false);
    if (!numbers.contains("rows_missing") || numbers["rows_missing"] != missing)
      fail("the report does not count the missing rows");
  }

  void judge_leftovers() {
    const auto orphans = nodes_on(ring_).size();
    tally_.orphans += static_cast<int>(orphans);
    if (orphans > 0) fail(fmt::format("{} processes are left", orphans));
    static_cast<void>(test::run_rths({"clean"}));
    const bool is_left = std::filesystem::exists("/dev/shm/rths." + ring_);
    tally_.rings += is_left ? 1 : 0;
    if (is_left) fail("the ring is left");
  }

  Blow blow_;
  Tally& tally_;
  test::TemporaryFolder folder_;
  std::string ring_;
  test::RingRemoval removal_;
  steady_clock::time_point begun_ = steady_clock::now();
  test::Running running_;
  steady_clock::time_point struck_;
  test::Finished finished_;
};

class DeathTrial : public ::testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] static int cases(const std::string& role) {
    if (test::is_long()) return 40;
    return role == "xpc" || role == "opf" ? 1 : 2;
  }
};

TEST_P(DeathTrial, BringsTheOthersToRestAndKeepsTheRecording) {
  const std::string role = GetParam();
  const char* const given = std::getenv("RTHS_SEED");
  const unsigned seed = given != nullptr ? static_cast<unsigned>(std::atoi(given)) : 7;
  std::seed_seq sequence{seed, static_cast<unsigned>(role[0]), static_cast<unsigned>(role[1])};
  std::mt19937 random{sequence};
  std::uniform_real_distribution<double> moment{0, role == "launcher" ? kLauncherEnds : kNodesEnd};
  std::uniform_real_distribution<double> stop{0.1, 5};
  Tally tally;
  // A process that has ended before its moment is no case. The bound ends a run that never starts.
  for (int tries = 0; tally.kills + tally.stops < cases(role) && tries < 4 * cases(role); ++tries) {
    Blow blow{role, moment(random), {}};
    if ((tally.kills + tally.stops) % 2 == 1) blow.stop = stop(random);
    static_cast<void>(Trial{blow, tally}.run());
  }

  fmt::print(
      "{}: seed {}, {} kills, {} stops, {} ended safely, {} completed, {} not started in time, "
      "slowest rest {:.2f} s after a kill, {:.2f} s after a stop, {} rows missing, {} of {} row "
      "times wrong, recordings {} absent {} broken, {} orphans, {} rings left\n",
      role, seed, tally.kills, tally.stops, tally.safe, tally.completed, tally.unstarted,
      tally.slowest_after_death, tally.slowest_after_stop, tally.rows_missing, tally.wrong_times,
      tally.compared, tally.absent, tally.broken, tally.orphans, tally.rings);
  std::fflush(stdout);
  RecordProperty("kills", tally.kills);
  RecordProperty("stops", tally.stops);
  RecordProperty("ended_safely", tally.safe);
  RecordProperty("completed", tally.completed);
  RecordProperty("not_started", tally.unstarted);
  RecordProperty("rest_after_kill_s", fmt::format("{:.2f}", tally.slowest_after_death));
  RecordProperty("rest_after_stop_s", fmt::format("{:.2f}", tally.slowest_after_stop));
  RecordProperty("wrong_times", fmt::format("{}", tally.wrong_times));
  RecordProperty("compared", fmt::format("{}", tally.compared));
  RecordProperty("broken", tally.broken);
  RecordProperty("orphans", tally.orphans);
  RecordProperty("rings", tally.rings);
  EXPECT_EQ(tally.failures, "");
  EXPECT_EQ(tally.kills + tally.stops, cases(role));
  EXPECT_GT(tally.compared, 0);
}

INSTANTIATE_TEST_SUITE_P(Of, DeathTrial,
                         ::testing::Values("srmd", "xpc", "opf", "recorder", "launcher"),
                         [](const auto& role) { return std::string{role.param}; });

}  // namespace
}  // namespace rths::launch
