// SPDX-License-Identifier: Apache-2.0
//
// The command as a script uses it. No test depends on times, since the machine may be busy.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/process.hpp"

namespace rths {
namespace {

using nlohmann::json;
using test::run_rths;

std::vector<std::string> short_bearings(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"bench", "bearings", "--passes", "1", "--steps", "300"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

void expect_ordered_times(const json& times) {
  EXPECT_GT(times["p50_ns"], 0);
  EXPECT_LE(times["p50_ns"], times["p99_ns"]);
  EXPECT_LE(times["p99_ns"], times["p999_ns"]);
  EXPECT_LE(times["p999_ns"], times["worst_ns"]);
  EXPECT_LE(times["worst_code_ns"], times["worst_ns"]);
}

TEST(BenchBearings, WritesOneJsonDocument) {
  const auto run = run_rths(short_bearings({"--json", "--opensees", "/no/such/python"}));

  ASSERT_GE(run.exit_code, 0) << run.err;
  ASSERT_LE(run.exit_code, 2) << run.err;
  const json document = json::parse(run.out);
  EXPECT_EQ(document["format"], 1);
  EXPECT_EQ(document["steps"], 300);
  EXPECT_TRUE(document["machine"].contains("cpu"));
  ASSERT_EQ(document["bearings"].size(), 3U);
  for (const json& row : document["bearings"]) {
    expect_ordered_times(row["earthquake"]);
    expect_ordered_times(row["adversarial"]);
    EXPECT_FALSE(row["terms"].empty());
    EXPECT_GT(row["dual_ratio"], 0);
    EXPECT_GT(row["one_of_486_ns"], 0);
  }
}

TEST(BenchBearings, ReportsWhyOpenseesIsNotMeasured) {
  const auto run = run_rths(short_bearings({"--opensees", "/no/such/python"}));

  EXPECT_NE(run.out.find("not measured: /no/such/python"), std::string::npos) << run.out;
  EXPECT_EQ(run.err, "");
}

TEST(BenchBearings, ExitsWithTheCodeOfItsResult) {
  const auto run = run_rths(short_bearings({"--json", "--opensees", "/no/such/python"}));

  const std::string result = json::parse(run.out)["result"];
  EXPECT_EQ(run.exit_code, result == "pass" ? 0 : result == "inconclusive" ? 1 : 2);
}

TEST(BenchBearings, ExitsWithThreeOnWrongArguments) {
  EXPECT_EQ(run_rths({"bench", "bearings", "--passes", "0"}).exit_code, 3);
  EXPECT_EQ(run_rths({"bench", "bearings", "--no-such"}).exit_code, 3);
}

}  // namespace
}  // namespace rths
