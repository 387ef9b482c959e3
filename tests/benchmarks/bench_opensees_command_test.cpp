// SPDX-License-Identifier: Apache-2.0
//
// The command as a script uses it. No test depends on times, since the machine may be busy.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/process.hpp"

namespace rths {
namespace {

using nlohmann::json;

// The benchmark itself checks that every force belongs to its displacement.
TEST(BenchOpenSees, MeasuresBothProtocolsBesideABarePingPong) {
  const auto run =
      test::run_rths({"bench", "opensees", "--json", "--cycles", "1", "--round-trips", "200"}, 120);

  ASSERT_GE(run.exit_code, 0) << run.err;
  ASSERT_LE(run.exit_code, 2) << run.err;
  const json document = json::parse(run.out);
  EXPECT_EQ(document["format"], 1);
  EXPECT_EQ(document["round_trips"], 200);
  const std::string result = document["result"];
  EXPECT_EQ(run.exit_code, result == "pass" ? 0 : result == "inconclusive" ? 1 : 2);
  if (document["trips"].empty()) GTEST_SKIP() << "SKIPPED: one processor only";
  ASSERT_EQ(document["trips"].size(), 2U);
  for (const json& trip : document["trips"]) {
    EXPECT_GT(trip["bare"]["p50_ns"], 0);
    EXPECT_LE(trip["bare"]["p50_ns"], trip["bare"]["p99_ns"]);
    EXPECT_LE(trip["through_ring"]["p50_ns"], trip["through_ring"]["p99_ns"]);
    EXPECT_GT(trip["ratio_p50"], 0);
  }
}

}  // namespace
}  // namespace rths
