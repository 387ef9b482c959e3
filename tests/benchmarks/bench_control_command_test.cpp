// SPDX-License-Identifier: Apache-2.0
//
// Benches in virtual time as a script uses them; few machines, so the goals are not judged here.
#include <sys/stat.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

using nlohmann::json;
using test::run_rths;

TEST(BenchForce, CorrectsAnEmptyTableBetterThanThePaper) {
  const auto run = run_rths({"bench", "force", "--json", "--seeds", "1"});

  ASSERT_GE(run.exit_code, 0) << run.err;
  const json document = json::parse(run.out);
  EXPECT_EQ(document["format"], 1);
  EXPECT_NEAR(document["largest_acceleration_m_per_s2"], 1.8 * 9.80665, 0.1);
  EXPECT_LE(document["ours"]["rms_largest_N"], 5e3);
  EXPECT_GT(document["paper"]["rms_largest_N"],
            2 * document["ours"]["rms_largest_N"].get<double>());
  EXPECT_EQ(document["parameters"].size(), 7U);
}

TEST(BenchVertical, TracksWhatTheCascadeCannot) {
  const auto run = run_rths({"bench", "vertical", "--json", "--draws", "1", "--duration", "10"});

  ASSERT_GE(run.exit_code, 0) << run.err;
  const json rows = json::parse(run.out)["rows"];
  EXPECT_FALSE(rows["cascade"]["meets_goals"]);
  EXPECT_GT(rows["cascade"]["nominal"]["rms"], 0.1);
  EXPECT_LE(rows["ours"]["worst"]["delay_s"], 2e-3);
  EXPECT_LE(rows["ours"]["worst"]["rms"], 0.02);
  EXPECT_LT(rows["cascade_slow"]["nominal"]["rms"], rows["cascade"]["nominal"]["rms"]);
}

TEST(BenchControl, ExitsWithThreeOnWrongArguments) {
  EXPECT_EQ(run_rths({"bench", "force", "--seeds", "0"}).exit_code, 3);
  EXPECT_EQ(run_rths({"bench", "vertical", "--duration", "1"}).exit_code, 3);
}

// Results that are written after hours: not into a pipe that no program reads, or a device.
TEST(BenchResults, ReplaceARegularFileOnly) {
  const test::TemporaryFolder folder;
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& file : {pipe, std::string{"/dev/null"}, folder.path().string()})
    for (const char* bench : {"srmd", "diagnosis"}) {
      const auto run = run_rths({"bench", bench, "--json", file}, 20);
      EXPECT_EQ(run.exit_code, 2) << bench << " " << file;
      EXPECT_NE(run.err.find(file + ": is no regular file, expected one for the results"),
                std::string::npos)
          << run.err;
    }
}

TEST(BenchResults, ReplaceNoRecording) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("run.h5", "\x89HDF\r\n\x1a\n").string();

  const auto run = run_rths({"bench", "srmd", "--json", file}, 20);

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("run.h5: is a recording, expected another file"), std::string::npos)
      << run.err;
}

TEST(BenchCard, WritesOneJsonDocument) {
  const auto run = run_rths({"bench", "card", "--json", "--passes", "1", "--seconds", "0.1"});
  ASSERT_GE(run.exit_code, 0) << run.err;
  ASSERT_LE(run.exit_code, 1) << run.err;
  const auto document = json::parse(run.out);
  ASSERT_EQ(document["rows"].size(), 6U);
  for (const auto& row : document["rows"]) {
    EXPECT_GT(row["hops_per_s"], 0);
    EXPECT_GT(row["megabytes_per_s"], 0);
  }
}

}  // namespace
}  // namespace rths
