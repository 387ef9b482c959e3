// SPDX-License-Identifier: Apache-2.0
//
// Hybrid tests on the machine with six degrees of freedom, in short: the figures are not judged.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/json.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

using Json = nlohmann::json;

TEST(SrmdBench, WritesItsFigures) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "srmd.json";
  const auto run = test::run_rths({"bench", "srmd", "--draws", "1", "--records", "1", "--seconds",
                                   "10", "--json", file.string()},
                                  120);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json results = test::json_of(file);

  EXPECT_EQ(results["rows"].size(), 2U);
  const Json& test = results["nominal"]["petrolia 1-D"][0];
  EXPECT_EQ(test["controller"], "paper");
  EXPECT_TRUE(test["stable"]);
  EXPECT_GT(test["axes"][0]["raw_delay_ms"], 55);
  EXPECT_LT(test["axes"][0]["raw_delay_ms"], 65);
  EXPECT_EQ(results["family"]["petrolia 1-D, paper"]["tests"], 1);
}

std::vector<std::string> bench_arguments(const std::filesystem::path& file,
                                         const std::string& seconds = "10") {
  return {"bench",     "srmd",  "--draws", "1", "--records", "1",
          "--seconds", seconds, "--jobs",  "2", "--json",    file.string()};
}

std::filesystem::path partial_of(std::filesystem::path file) { return file += ".partial"; }

// Starts the benchmark and kills it when `tests` of its four tests are finished.
void interrupt_bench(const std::filesystem::path& file, std::size_t tests) {
  auto command = bench_arguments(file);
  command.insert(command.begin(), test::rths_command());
  const test::Running bench{command};
  const auto lines = [&] {
    std::ifstream partial{partial_of(file)};
    return static_cast<std::size_t>(std::count(std::istreambuf_iterator<char>{partial}, {}, '\n'));
  };
  while (lines() < 1 + tests && test::is_running(bench.pid()))
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
}

// Results without times.
Json figures_of(const std::filesystem::path& file) {
  Json results = test::json_of(file);
  results.erase("step_us");
  return results;
}

TEST(SrmdBench, ContinuesAnInterruptedRun) {
  const test::TemporaryFolder folder;
  const auto whole = folder.path() / "whole.json", resumed = folder.path() / "resumed.json";
  ASSERT_EQ(test::run_rths(bench_arguments(whole), 120).exit_code, 0);
  interrupt_bench(resumed, 1);
  ASSERT_TRUE(std::filesystem::exists(partial_of(resumed)));
  // A line without its end, as of a full disk.
  std::ofstream{partial_of(resumed), std::ios::app} << R"({"name":[1,"petr)";

  const auto run = test::run_rths(bench_arguments(resumed), 120);

  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(figures_of(resumed).dump(), figures_of(whole).dump());
  EXPECT_FALSE(std::filesystem::exists(partial_of(resumed)));
}

TEST(SrmdBench, DoesNotRepeatFinishedTests) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "srmd.json";
  interrupt_bench(file, 1);
  std::string partial = test::content_of(partial_of(file));
  const auto at = partial.find("\"limit_periods\":0");
  ASSERT_NE(at, std::string::npos) << partial;
  partial.replace(at, 17, "\"limit_periods\":7");
  std::ofstream{partial_of(file)} << partial;

  const auto run = test::run_rths(bench_arguments(file), 120);

  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json results = test::json_of(file);
  long limits = 0;
  for (const auto& row : results["rows"])
    for (const auto& test : row["tests"]) limits += test["limit_periods"].get<long>();
  EXPECT_EQ(limits, 7);
}

TEST(SrmdBench, RefusesFinishedTestsOfOtherOptions) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "srmd.json";
  interrupt_bench(file, 0);

  const auto run = test::run_rths(bench_arguments(file, "11"), 60);

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("another program or with other options"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("\"duration_s\":11.0"), std::string::npos) << run.err;
}

TEST(SrmdBench, RefusesNumbersOutOfRange) {
  EXPECT_NE(test::run_rths({"bench", "srmd", "--draws", "201"}, 60).exit_code, 0);
  EXPECT_NE(test::run_rths({"bench", "srmd", "--records", "0"}, 60).exit_code, 0);
}

}  // namespace
}  // namespace rths
