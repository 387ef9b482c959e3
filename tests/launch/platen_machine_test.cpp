// SPDX-License-Identifier: Apache-2.0
//
// Hybrid tests on the machine with six degrees of freedom: the example, and the benchmark.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/json.hpp"
#include "support/process.hpp"

namespace rths::launch {
namespace {

using Json = nlohmann::json;

// The run without compensation has no feed-forward, although `tune` sets one.
TEST(PlatenExample, HasThePapersDelays) {
  const test::TemporaryFolder folder;
  const auto run = test::run_rths(
      {"run", (test::source_tree() / "examples/srmd_platen_2d.toml").string(), "--clock", "virtual",
       "--set", "duration_s=10", "--out", folder.path().string()},
      120);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json report = test::json_of(folder.path() / "report.json");

  for (const char* name : {"long", "lat"}) {
    const Json& axis = report["axes"][name];
    EXPECT_GT(axis["delay_raw_ms"], 55) << name;
    EXPECT_LT(axis["delay_raw_ms"], 65) << name;
    EXPECT_LT(axis["delay_compensated_ms"], 6.5) << name;
    EXPECT_LT(axis["nrms_percent"], 1.5) << name;
  }
}

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

TEST(SrmdBench, RefusesNumbersOutOfRange) {
  EXPECT_NE(test::run_rths({"bench", "srmd", "--draws", "201"}, 60).exit_code, 0);
  EXPECT_NE(test::run_rths({"bench", "srmd", "--records", "0"}, 60).exit_code, 0);
}

}  // namespace
}  // namespace rths::launch
