// SPDX-License-Identifier: Apache-2.0
//
// `rths diagnose RING --live` beside a test in real time, ten times slower than model time.
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/broker/ring.hpp>

#include "support/files.hpp"
#include "support/json.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"
#include "support/test_alone.hpp"
#include "support/waiting.hpp"

namespace rths {
namespace {

namespace fs = std::filesystem;
using test::run_rths;

/// Strong motion from the start: a sweep along both axes, and a vertical one that varies the load.
std::string strong_motion() {
  std::string text = "time,long,lat,vert\n";
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.005 * i, rise = std::min(1.0, t / 0.3);
    text += fmt::format("{:.3f},{:.6f},{:.6f},{:.6f}\n", t,
                        0.3 * rise * std::sin(2 * M_PI * (0.8 + 0.2 * t) * t),
                        0.2 * rise * std::sin(2 * M_PI * (1.1 - 0.1 * t) * t),
                        0.3 * rise * std::sin(2 * M_PI * 4.7 * t));
  }
  return text;
}

class Live : public ::testing::Test {
 protected:
  /// Starts a test whose bearing has a strength proportional to its load, which its model omits.
  void start(double duration, const std::string& rate = "10") {
    const auto motion = folder_.write("motion.csv", strong_motion()).string();
    std::vector<std::string> words{
        test::rths_command(),
        "run",
        (test::source_tree() / "examples/mismatch_coupling.toml").string(),
        "--set",
        fmt::format("duration_s={}", duration),
        "--set",
        "rate=" + rate,
        "--set",
        "rest_s=1",
        "--set",
        "axes=[\"long\"]",
        "--set",
        "motion.file=" + motion,
        "--set",
        "motion.scale=1",
        "--set",
        "motion.column_long=1",
        "--set",
        "motion.column_lat=2",
        "--out",
        run_.string(),
        "--ring",
        ring_,
        "--no-diagnosis"};
    words.insert(words.end(), test::kTestAlone.begin(), test::kTestAlone.end());
    running_ = std::make_unique<test::Running>(words);
    ASSERT_TRUE(test::comes_true([&] { return fs::exists(run_ / "run.h5"); }));
  }
  [[nodiscard]] std::vector<std::string> diagnosis(const std::string& interval) const {
    return {test::rths_command(), "diagnose", ring_,   "--live",
            "--every-s",          interval,   "--out", out_.string()};
  }

  test::TemporaryFolder folder_;
  fs::path run_ = folder_.path() / "run", out_ = folder_.path() / "verdict";
  std::string ring_ = test::unique_ring("live");
  test::RingRemoval removal_{ring_};
  std::unique_ptr<test::Running> running_;
};

bool has_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == text.size() - 1;
}

// Whether the process of a look runs, at the lowest priority.
bool has_quiet_look(int live) {
  for (const int child : test::children_of(live))
    if (sched_getscheduler(child) == SCHED_IDLE &&
        getpriority(PRIO_PROCESS, static_cast<id_t>(child)) == 19)
      return true;
  return false;
}

// The host may be busy with other work, which would keep the looks waiting: they get the priority
// of this test.
void hasten_children_of(int process) {
  const sched_param none{};
  for (const int child : test::children_of(process)) {
    sched_setscheduler(child, SCHED_OTHER, &none);
    setpriority(PRIO_PROCESS, static_cast<id_t>(child), getpriority(PRIO_PROCESS, 0));
    hasten_children_of(child);
  }
}

/// Hastens the looks of a diagnosis as long as it runs.
class Hastening {
 public:
  explicit Hastening(int live)
      : thread_{[live] {
          while (test::is_running(live)) {
            hasten_children_of(live);
            std::this_thread::sleep_for(std::chrono::milliseconds{50});
          }
        }} {}
  ~Hastening() { thread_.join(); }
  Hastening(const Hastening&) = delete;
  Hastening& operator=(const Hastening&) = delete;

 private:
  std::thread thread_;
};

// Lines before that of the last look.
std::string while_running(const std::string& out) {
  return out.substr(0, out.find("the test has ended"));
}

TEST_F(Live, NamesTheConcealedEffectBeforeTheEnd) {
  start(3.2);
  test::Running live{diagnosis("4")};
  const Hastening hastening{live.pid()};

  const auto found = live.wait(300);
  const auto finished = running_->wait(120);

  ASSERT_EQ(found.exit_code, 0) << found.out << found.err;
  EXPECT_EQ(found.err, "");
  EXPECT_NE(while_running(found.out).find("strength that depends on the axial load"),
            std::string::npos)
      << found.out;
  EXPECT_NE(found.out.find("too early: "), std::string::npos) << found.out;
  for (const char* answer : {"\nmissing   ", "\nsure      ", "\nnow       "})
    EXPECT_NE(found.out.find(answer), std::string::npos) << answer << found.out;
  EXPECT_NE(found.out.find("the test has ended (completed), at 3.2"), std::string::npos)
      << found.out;
  EXPECT_EQ(test::json_of(out_ / "verdict.json")["causes"][0]["name"], "axial_load_strength");
  EXPECT_FALSE(fs::exists(out_ / ".lock"));
  EXPECT_GE(finished.exit_code, 0);
  EXPECT_LE(finished.exit_code, 1) << finished.err;
}

TEST_F(Live, LooksQuietlyAndEndsAtOnceWhenItIsInterrupted) {
  start(60);
  test::Running live{diagnosis("5")};
  ASSERT_TRUE(test::comes_true([&] { return has_quiet_look(live.pid()); }));
  test::Running second{diagnosis("5")};

  const auto refused = second.wait(60);
  kill(live.pid(), SIGINT);
  const auto ended = live.wait(30);

  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("is in use by process"), std::string::npos) << refused.err;
  EXPECT_TRUE(has_one_line(refused.err)) << refused.err;
  EXPECT_EQ(ended.exit_code, 1) << ended.out << ended.err;
  EXPECT_LT(ended.host_seconds, 20);
  EXPECT_FALSE(fs::exists(out_)) << "it has left its folder";
  EXPECT_TRUE(test::is_running(running_->pid())) << "the test was disturbed";
}

TEST_F(Live, SaysHowATestEndedWhoseRecorderWasKilled) {
  start(60, "1");
  test::Running live{diagnosis("60")};
  const Hastening hastening{live.pid()};
  ASSERT_TRUE(test::comes_true([&] { return fs::exists(out_ / ".lock"); }));
  const auto report = broker::inspect_ring(ring_);
  ASSERT_TRUE(report);
  for (const auto& occupant : report->occupants)
    if (occupant.node == "recorder") kill(occupant.pid, SIGKILL);

  const auto ended = live.wait(120);

  EXPECT_EQ(ended.exit_code, 2) << ended.out;
  EXPECT_NE(ended.out.find("the rate of the test is 1, expected at least 10"), std::string::npos)
      << ended.out;
  EXPECT_NE(ended.err.find("the test has ended (recorder (process "), std::string::npos)
      << ended.err;
  EXPECT_NE(ended.err.find("its last look has no verdict: "), std::string::npos) << ended.err;
  EXPECT_TRUE(has_one_line(ended.err)) << ended.err;
  EXPECT_FALSE(fs::exists(out_));
}

TEST(LiveCommand, NeedsTheRingOfARunningTest) {
  const test::TemporaryFolder folder;
  const auto out = (folder.path() / "out").string();

  const auto run = run_rths({"diagnose", test::unique_ring("none"), "--live", "--out", out});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("there is no ring '"), std::string::npos) << run.err;
  EXPECT_TRUE(has_one_line(run.err)) << run.err;
  EXPECT_FALSE(fs::exists(out));
}

TEST(LiveCommand, NeedsALauncherOnTheRing) {
  const std::string name = test::unique_ring("no_test");
  const test::RingRemoval removal{name};
  const auto ring = broker::Ring::create(name, test::small_map());

  const auto run = run_rths({"diagnose", name, "--live"});

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("has no launcher: expected the ring of a running test"), std::string::npos)
      << run.err;
}

TEST(LiveCommand, RefusesOptionsOfOtherDiagnoses) {
  for (const char* option : {"--plan", "--json"})
    EXPECT_EQ(run_rths({"diagnose", "none", "--live", option}).exit_code, 3) << option;
  EXPECT_EQ(run_rths({"diagnose", "none", "--every-s", "5"}).exit_code, 3);
}

}  // namespace
}  // namespace rths
