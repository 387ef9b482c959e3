// SPDX-License-Identifier: Apache-2.0
//
// The command as a script uses it. No test depends on times, since the machine may be busy.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/broker/ring.hpp>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

using nlohmann::json;
using test::Finished;
using test::run_rths;

// One short cycle: fast, and inconclusive.
const std::vector<std::string> kShort{"bench", "ring", "--cycles", "1", "--round-trips", "200"};

std::vector<std::string> short_ring(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = kShort;
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

void expect_measured_row(const json& row) {
  for (const char* key : {"name", "bytes", "what", "p50_ns", "p99_ns", "ratio_p50", "ratio_p50_95",
                          "ratio_p99", "quantity", "value", "value_95", "cycles", "noisy", "goal",
                          "gate", "goal_p99", "gate_p99", "verdict"})
    EXPECT_TRUE(row.contains(key)) << key << " in " << row;
  EXPECT_GT(row["p50_ns"], 0);
  EXPECT_EQ(row["ratio_p50_95"].size(), 2);
}

TEST(BenchRing, WritesOneJsonDocument) {
  const Finished run = run_rths(short_ring({"--json", "--seed", "7"}), 110);

  ASSERT_EQ(run.exit_code, 1) << run.err;
  const json document = json::parse(run.out);
  EXPECT_EQ(document["format"], 1);
  EXPECT_EQ(document["result"], "inconclusive");
  EXPECT_FALSE(document["troubles"].empty());
  EXPECT_EQ(document["seed"], 7);
  for (const char* key :
       {"cpu", "processors", "used", "smt_siblings", "kernel", "hypervisor", "huge_pages"})
    EXPECT_TRUE(document["machine"].contains(key)) << key;
  if (document["machine"]["used"].empty()) GTEST_SKIP() << "SKIPPED: one processor only";
  for (const json& row : document["rows"])
    if (!row.contains("missing")) expect_measured_row(row);
  for (const json& row : document["peers"]) {
    EXPECT_TRUE(row.contains("against"));
    if (!row.contains("missing")) expect_measured_row(row);
  }
}

TEST(BenchRing, PrintsATableOfTheSelectedRowsAndThoseTheyNeed) {
  const Finished run = run_rths(short_ring({"--row", "message_queue_8"}));

  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_NE(run.out.find("message_queue_8"), std::string::npos);
  EXPECT_NE(run.out.find("\nword "), std::string::npos);
  EXPECT_EQ(run.out.find("group_64"), std::string::npos);
  EXPECT_NE(run.out.find("INCONCLUSIVE"), std::string::npos);
  EXPECT_EQ(run.err, "");
}

TEST(BenchRing, LeavesNoRingBehind) {
  static_cast<void>(run_rths(short_ring({"--row", "group_1024"})));

  for (const auto& ring : broker::list_rings()) EXPECT_NE(ring.name.rfind("bench_", 0), 0U);
}

TEST(BenchRing, ContinuesWithItsStoredCycles) {
  const test::TemporaryFolder folder;
  const auto run = [&] {
    return run_rths(short_ring({"--json", "--row", "word", "--keep", folder.path().string()}));
  };

  const Finished first = run();
  const Finished second = run();

  EXPECT_TRUE(std::filesystem::exists(folder.path() / "cycle-00.json"));
  EXPECT_EQ(json::parse(first.out)["rows"], json::parse(second.out)["rows"]);
}

TEST(BenchRing, RepeatsAnIncompleteCycle) {
  const test::TemporaryFolder folder;
  folder.write("cycle-00.json", "{\"round_trips\": 200, ");

  const Finished run =
      run_rths(short_ring({"--json", "--row", "word", "--keep", folder.path().string()}));

  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_TRUE(json::accept(test::content_of(folder.path() / "cycle-00.json")));
}

TEST(BenchRing, ExitsWithThreeOnWrongArguments) {
  EXPECT_EQ(run_rths({"bench"}).exit_code, 3);
  EXPECT_EQ(run_rths({"bench", "ring", "--row", "no_such_row"}).exit_code, 3);
  EXPECT_EQ(run_rths({"bench", "ring", "--cycles", "0"}).exit_code, 3);
}

TEST(BenchCommand, HasHelpForEveryBenchmark) {
  for (const char* bench : {"ring", "bearings", "srmd", "card", "opensees", "bridge", "diagnosis",
                            "force", "vertical"}) {
    const Finished help = run_rths({"bench", bench, "--help"});
    EXPECT_EQ(help.exit_code, 0) << bench;
    EXPECT_NE(help.out.find("--json"), std::string::npos) << bench;
  }
}

TEST(BenchCommand, ReportsWrongUsageInOneLineWithTheHelpToRead) {
  const Finished misspelt = run_rths({"bench", "rnig"});
  EXPECT_EQ(misspelt.exit_code, 3);
  EXPECT_EQ(misspelt.err.rfind("rths bench: there is no command 'rnig' (did you mean 'ring'?)", 0),
            0U)
      << misspelt.err;
  const Finished wrong = run_rths({"bench", "ring", "--no-such"});
  EXPECT_NE(wrong.err.find("; see rths bench ring --help\n"), std::string::npos) << wrong.err;
}

TEST(BenchCommand, IsCompletedByTheShell) {
  EXPECT_EQ(run_rths({"complete", "ben"}).out, "bench\n");
  EXPECT_EQ(run_rths({"complete", "bench", "be"}).out, "bearings\n");
  EXPECT_EQ(run_rths({"complete", "bench", "card", "--pa"}).out, "--passes\n");
  EXPECT_EQ(run_rths({"complete", "bench", "ring", "--row", "raw_"}).out, "raw_pause\n");
}

TEST(BenchCommand, HasAManualPage) {
  const std::string program = test::rths_command() + "-bench";
  const std::string page = test::Running{{program, "manual"}}.wait().out;

  EXPECT_EQ(page.rfind(".TH RTHS-BENCH 1", 0), 0U);
  EXPECT_NE(page.find(".SS rths bench ring"), std::string::npos);
}

}  // namespace
}  // namespace rths
