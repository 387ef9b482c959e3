// SPDX-License-Identifier: Apache-2.0
//
// Programs that have the recording open at the end of a run in real time cost it no report.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"
#include "support/waiting.hpp"

namespace rths::launch {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPython = "/usr/bin/python3";
// Opens the recording as soon as that succeeds, says so in a file, and keeps it open.
constexpr const char* kReader = R"(
import fcntl, pathlib, sys, time
file, how = sys.argv[1:]
while True:
    try:
        if how == "locked":
            held = open(file)
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            import h5py
            held = h5py.File(file, "r", swmr=how == "swmr")
        break
    except OSError:
        time.sleep(0.002)
pathlib.Path(file + "." + how).touch()
time.sleep(600)
)";

bool has_h5py() { return test::Running{{kPython, "-c", "import h5py"}}.wait().exit_code == 0; }

class RunWithReaders : public ::testing::Test {
 protected:
  /// Starts a short run in real time, and waits for its recording.
  void SetUp() override {
    run_ = std::make_unique<test::Running>(std::vector<std::string>{
        test::rths_command(), "run", (test::source_tree() / "examples/srmd_lprb_2d.toml").string(),
        "--set", "duration_s=3", "--out", out_.string(), "--ring", ring_, "--no-diagnosis"});
    ASSERT_TRUE(test::comes_true([&] { return fs::exists(file_); }));
  }
  void start_reader(const std::string& how) {
    readers_.push_back(std::make_unique<test::Running>(
        std::vector<std::string>{kPython, "-c", kReader, file_.string(), how}));
  }
  [[nodiscard]] bool is_open(const std::string& how) const {
    return test::comes_true([&] { return fs::exists(file_.string() + "." + how); });
  }
  void expect_report() {
    const auto finished = run_->wait(120);
    EXPECT_LE(finished.exit_code, 1) << finished.out << finished.err;
    EXPECT_GE(finished.exit_code, 0) << finished.err;
    ASSERT_TRUE(fs::exists(out_ / "report.json")) << finished.err;
    const recording::Reader recorded{file_};
    EXPECT_GT(recorded.rows(), 1000U);
    EXPECT_EQ(recorded.meta().at("ending"), "completed");
  }

  test::TemporaryFolder folder_;
  fs::path out_ = folder_.path() / "out", file_ = out_ / "run.h5";
  std::string ring_ = test::unique_ring("readers");
  test::RingRemoval removal_{ring_};
  std::unique_ptr<test::Running> run_;
  std::vector<std::unique_ptr<test::Running>> readers_;
};

TEST_F(RunWithReaders, OfH5pyHasItsReport) {
  if (!has_h5py()) GTEST_SKIP() << "SKIPPED: " << kPython << " has no h5py";
  start_reader("swmr");
  start_reader("plain");  // opens it at the end
  ASSERT_TRUE(is_open("swmr"));

  expect_report();

  EXPECT_TRUE(is_open("plain"));
}

TEST_F(RunWithReaders, OfRthsHasItsReport) {
  const recording::Reader held{file_};
  bool exported = false;
  while (test::is_running(run_->pid())) {
    const auto table = test::run_rths({"export", out_.string(), "--signals", "srmd.*.fbk"});
    exported = exported || table.exit_code == 0;
  }

  expect_report();

  EXPECT_TRUE(exported);
}

TEST_F(RunWithReaders, ThatLockItHasItsReport) {
  start_reader("locked");  // when the recorder has closed it

  expect_report();

  EXPECT_TRUE(is_open("locked"));
}

}  // namespace
}  // namespace rths::launch
