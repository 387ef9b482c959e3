// SPDX-License-Identifier: Apache-2.0
//
// The output folder of a run: its own for each run, locked, and safe for earlier results.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>

#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>

#include "support/diagrams.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/test_alone.hpp"

namespace rths::launch {
namespace {

namespace fs = std::filesystem;

/// A folder in which `rths` runs.
class RunFolder : public ::testing::Test {
 protected:
  [[nodiscard]] test::Finished rths(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command{"/usr/bin/env", "-C", place.path().string(),
                                     test::rths_command()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return test::Running{command}.wait(60);
  }
  /// Runs 2 s of the example in virtual time.
  [[nodiscard]] test::Finished run(const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments{
        "run",
        (test::source_tree() / "examples/srmd_lprb_2d.toml").string(),
        "--clock",
        "virtual",
        "--no-diagnosis",
        "--set",
        "duration_s=2",
        "--set",
        "rest_s=0.1"};
    arguments.insert(arguments.end(), test::kTestAlone.begin(), test::kTestAlone.end());
    arguments.insert(arguments.end(), options.begin(), options.end());
    return rths(arguments);
  }
  /// Options with which no run can start: the controller writes a signal that is not in the map.
  [[nodiscard]] std::vector<std::string> unknown_signal() const {
    const auto diagram = place.write("unknown.toml", test::zero_diagram("daq.nothing"));
    return {"--set", "node.xpc.diagram=\"" + diagram.string() + "\"", "--set",
            "node.xpc.constants=\"" + place.write("none.toml", "").string() + "\""};
  }
  [[nodiscard]] fs::path at(const std::string& path) const { return place.path() / path; }
  /// Names and contents of all files of a folder.
  [[nodiscard]] static std::map<std::string, std::string> content(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator{folder})
      files[entry.path().filename().string()] = test::content_of(entry.path());
    return files;
  }
  /// Folders of the runs of the example.
  [[nodiscard]] std::vector<std::string> runs() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator{at("out/srmd_lprb_2d")})
      if (!entry.is_symlink()) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
  [[nodiscard]] std::string latest() const {
    return fs::read_symlink(at("out/srmd_lprb_2d/latest")).string();
  }

  test::TemporaryFolder place;
};

TEST_F(RunFolder, IsNewForEachRunAndLinkedAsTheLatest) {
  ASSERT_EQ(run().exit_code, 0);
  const std::string first = latest();
  const auto results = content(at("out/srmd_lprb_2d") / first);

  const auto second = run({"--set", "seed=2"});

  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(runs(), (std::vector<std::string>{first, latest()}));
  EXPECT_NE(latest(), first);
  for (const auto& name : runs())
    EXPECT_TRUE(std::regex_match(name, std::regex{R"(\d{4}-\d\d-\d\dT\d{6}Z(\.\d+)?)"})) << name;
  EXPECT_NE(second.out.find("report    out/srmd_lprb_2d/" + latest() + "/report.html"),
            std::string::npos)
      << second.out;
  EXPECT_EQ(content(at("out/srmd_lprb_2d") / first), results);
  EXPECT_TRUE(results.contains("run.h5"));
  EXPECT_FALSE(results.contains(".lock"));
}

TEST_F(RunFolder, LeavesNothingBehindIfTheRunCannotStart) {
  const auto failed = run(unknown_signal());
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_NE(failed.err.find("daq.nothing"), std::string::npos) << failed.err;
  EXPECT_FALSE(fs::exists(at("out")));

  ASSERT_EQ(run().exit_code, 0);
  const std::string first = latest();
  EXPECT_EQ(run(unknown_signal()).exit_code, 2);

  EXPECT_EQ(latest(), first);
  EXPECT_EQ(runs(), std::vector<std::string>{first});
}

TEST_F(RunFolder, KeepsEarlierResultsUnlessForced) {
  fs::create_directory(at("mine"));
  place.write("mine/run.h5", "an earlier recording");
  place.write("mine/verdict.json", "an earlier verdict");
  place.write("mine/notes.txt", "notes");
  const auto earlier = content(at("mine"));

  const auto refused = run({"--out", "mine"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err,
            "rths: mine: holds the results of an earlier run, expected another folder, or --force "
            "to replace them\n");
  EXPECT_EQ(content(at("mine")), earlier);

  auto options = unknown_signal();
  options.insert(options.end(), {"--out", "mine", "--force"});
  EXPECT_EQ(run(options).exit_code, 2);
  EXPECT_EQ(content(at("mine")), earlier);

  const auto forced = run({"--out", "mine", "--force"});
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  auto replaced = content(at("mine"));
  EXPECT_TRUE(recording::is_hdf5(at("mine/run.h5")));
  EXPECT_TRUE(replaced.contains("report.html"));
  EXPECT_FALSE(replaced.contains("verdict.json"));
  EXPECT_EQ(replaced["notes.txt"], "notes");
  EXPECT_FALSE(replaced.contains(".earlier"));
}

TEST_F(RunFolder, GetsBackResultsThatAKilledStartSetAside) {
  fs::create_directories(at("mine/.earlier"));
  place.write("mine/.earlier/report.json", "an earlier report");
  place.write("mine/run.h5", "of the start that was killed");
  place.write("mine/.lock", "");

  EXPECT_EQ(run({"--out", "mine"}).exit_code, 2);

  EXPECT_EQ(content(at("mine")),
            (std::map<std::string, std::string>{{"report.json", "an earlier report"}}));
}

TEST_F(RunFolder, GetsThemBackForAReport) {
  fs::create_directories(at("mine/.earlier"));
  place.write("mine/.earlier/run.h5", "of an earlier run");

  static_cast<void>(test::run_rths({"report", at("mine").string()}));

  EXPECT_EQ(content(at("mine")),
            (std::map<std::string, std::string>{{"run.h5", "of an earlier run"}}));
}

TEST_F(RunFolder, IsRefusedAtOnceWhileAProcessWritesToIt) {
  fs::create_directory(at("mine"));
  place.write("mine/run.h5", "a recording");
  const int lock = open(place.write("mine/.lock", "").c_str(), O_RDWR | O_CLOEXEC);
  struct flock whole {};
  whole.l_type = F_WRLCK;
  ASSERT_EQ(fcntl(lock, F_SETLK, &whole), 0);
  const std::string expected = "rths: mine: is in use by process " + std::to_string(getpid()) +
                               ", expected a folder that no process writes to\n";

  EXPECT_EQ(run({"--out", "mine"}).err, expected);
  EXPECT_EQ(run({"--out", "mine", "--force"}).err, expected);
  EXPECT_EQ(rths({"report", "mine"}).err, expected);
  EXPECT_EQ(rths({"diagnose", (test::source_tree() / "examples/diagnosis/actuator").string(),
                  "--out", "mine"})
                .err,
            expected);

  close(lock);
  EXPECT_EQ(test::content_of(at("mine/run.h5")), "a recording");
  EXPECT_EQ(run({"--out", "mine", "--force"}).exit_code, 0);
}

TEST_F(RunFolder, IsReportedInOneLineIfItCannotBeWritten) {
  place.write("file", "");
  EXPECT_EQ(run({"--out", "file"}).err, "rths: file: cannot be created: Not a directory\n");
  EXPECT_EQ(rths({"report", "nowhere"}).err,
            "rths: nowhere: is no folder, expected that of a run\n");

  // A folder in which not even root may create files, for the reason that the system gives.
  const std::string folder = "/proc/sys";
  const int file = open((folder + "/.lock").c_str(), O_RDWR | O_CREAT, 0666);
  ASSERT_LT(file, 0);
  const std::string reason = std::strerror(errno);
  const auto refused = run({"--out", folder});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err, "rths: " + folder + ": cannot be written: " + reason + "\n");
}

TEST_F(RunFolder, IsFollowedThroughTheLinkToTheLatest) {
  ASSERT_EQ(run().exit_code, 0);
  const auto results = at("out/srmd_lprb_2d") / latest();
  fs::remove(results / "report.html");

  const auto reported = rths({"report", "out/srmd_lprb_2d/latest"});
  EXPECT_EQ(reported.exit_code, 0) << reported.err;
  EXPECT_TRUE(fs::exists(results / "report.html"));

  // The improved model stays the same file when `latest` becomes the new run.
  static_cast<void>(place.write((results / "improved.toml").string(),
                                "[specimen.bouc_wen]\ncharacteristic_strength_N = 1_000_000\n"));
  ASSERT_EQ(run({"--improve", "out/srmd_lprb_2d/latest/improved.toml"}).exit_code, 0);
  EXPECT_EQ(recording::Reader{at("out/srmd_lprb_2d/latest/run.h5")}
                .config(recording::kOverridesText)
                .find("latest"),
            std::string::npos);

  std::ofstream{at("out/srmd_lprb_2d/latest/run.h5")} << "no recording";
  EXPECT_NE(rths({"diagnose", "out/srmd_lprb_2d/latest"}).err.find("latest/run.h5: "),
            std::string::npos);
}

}  // namespace
}  // namespace rths::launch
