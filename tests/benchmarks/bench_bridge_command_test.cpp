// SPDX-License-Identifier: Apache-2.0
//
// The command as a script uses it. No test depends on times, since the machine may be busy.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/process.hpp"

namespace rths {
namespace {

using nlohmann::json;

TEST(BenchBridge, MeasuresEveryRowAndLosesNothing) {
  const auto run =
      test::run_rths({"bench", "bridge", "--json", "--cycles", "1", "--updates", "200000"}, 120);

  ASSERT_GE(run.exit_code, 0) << run.err;
  ASSERT_LE(run.exit_code, 2) << run.err;
  const json document = json::parse(run.out);
  const std::string result = document["result"];
  EXPECT_EQ(run.exit_code, result == "pass" ? 0 : result == "inconclusive" ? 1 : 2);
  if (document["machine"]["processors"] == 1) GTEST_SKIP() << "SKIPPED: one processor only";
  const json& rows = document["rows"];
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_GT(rows[0]["updates_ratio"], 0);
  EXPECT_EQ(rows[0]["lost"], 0);
  EXPECT_EQ(rows[0]["reordered"], 0);
  EXPECT_GT(rows[1]["latency_ratio_p50"], 0);
  EXPECT_GT(rows[2]["seconds"], 0);
  EXPECT_GT(rows[3]["far_share"], 0);
}

}  // namespace
}  // namespace rths
