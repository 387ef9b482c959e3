// SPDX-License-Identifier: Apache-2.0
//
// The command as scripts meet it. Nothing here is judged by time: the machine may be busy.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/process.hpp"

namespace rths {
namespace {

using nlohmann::json;

// The bench itself checks that every force that comes back is that of its displacement.
TEST(BenchOpenSees, MeasuresBothProtocolsBesideABarePingPong) {
  const auto run =
      test::run_rths({"bench", "opensees", "--json", "--cycles", "1", "--round-trips", "200"}, 120);

  ASSERT_GE(run.exit_code, 0) << run.err;
  ASSERT_LE(run.exit_code, 2) << run.err;
  const json said = json::parse(run.out);
  EXPECT_EQ(said["format"], 1);
  EXPECT_EQ(said["round_trips"], 200);
  const std::string result = said["result"];
  EXPECT_EQ(run.exit_code, result == "pass" ? 0 : result == "inconclusive" ? 1 : 2);
  if (said["trips"].empty()) GTEST_SKIP() << "SKIPPED: one processor only";
  ASSERT_EQ(said["trips"].size(), 2U);
  for (const json& trip : said["trips"]) {
    EXPECT_GT(trip["bare"]["p50_ns"], 0);
    EXPECT_LE(trip["bare"]["p50_ns"], trip["bare"]["p99_ns"]);
    EXPECT_LE(trip["through_ring"]["p50_ns"], trip["through_ring"]["p99_ns"]);
    EXPECT_GT(trip["ratio_p50"], 0);
  }
}

}  // namespace
}  // namespace rths
