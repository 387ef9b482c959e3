// SPDX-License-Identifier: Apache-2.0
#include <rths/session/run.hpp>

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "support/files.hpp"

namespace rths::session {
namespace {

/// A short test in virtual time.
class Run : public ::testing::Test {
 protected:
  Run() {
    settings.experiment = test::source_tree() / "examples/srmd_lprb_2d.toml";
    settings.changes = {{"duration_s", "3"}, {"rest_s", "0.5"}};
    settings.clock = launch::ClockKind::Virtual;
    settings.out = temporary.path() / "out";
    settings.diagnoses = false;
    progress.note = [this](const std::string& line) { notes.push_back(line); };
    progress.step = [this](int number, int count, const std::string& name) {
      steps.push_back(std::to_string(number) + " of " + std::to_string(count) + ": " + name);
    };
  }

  const test::TemporaryFolder temporary;
  RunSettings settings;
  Progress progress;
  std::vector<std::string> notes, steps;
};

TEST_F(Run, GivesTheRecordingAndTheReport) {
  bool is_recorded = false;
  progress.recorded = [&](const RunResult& test) {
    is_recorded = true;
    EXPECT_EQ(test.recording, settings.out / report::kRunFile);
    EXPECT_FALSE(test.report);
  };

  const RunResult result = run(settings, progress);

  EXPECT_TRUE(is_recorded);
  EXPECT_TRUE(result.outcome.completed);
  EXPECT_EQ(result.ending(), "completed");
  EXPECT_EQ(result.folder, settings.out);
  EXPECT_TRUE(result.not_made.empty());
  EXPECT_TRUE(std::filesystem::exists(settings.out / report::kNumericalFile));
  ASSERT_TRUE(result.report);
  EXPECT_EQ(result.is_conclusive(), result.report->conclusive);
  EXPECT_EQ(result.report->conclusive, result.broken.empty());
  EXPECT_FALSE(result.diagnosis);
  EXPECT_EQ(steps.front(), "1 of 4: the test without compensation");
  EXPECT_EQ(steps.back(), "4 of 4: the report");
}

TEST_F(Run, KeepsTheResultsOfAnEarlierOne) {
  static_cast<void>(run(settings, progress));

  EXPECT_THROW(static_cast<void>(run(settings, progress)), Error);

  EXPECT_TRUE(std::filesystem::exists(settings.out / report::kRunFile));
}

TEST_F(Run, LeavesNoFolderIfTheTestCannotBegin) {
  settings.host = "nowhere";

  EXPECT_THROW(static_cast<void>(run(settings, progress)), Error);

  EXPECT_FALSE(std::filesystem::exists(settings.out));
}

TEST_F(Run, IsOneJsonDocument) {
  RunResult result;
  result.folder = "out/a \"test\"";
  result.outcome.trouble = "node x died";
  result.broken = {{"tracking", 1.5, "xpc.long", "9 %", "at most 5 %"}};

  const std::string text = json_of(result);

  EXPECT_NE(text.find(R"("folder": "out/a \"test\"")"), std::string::npos) << text;
  EXPECT_NE(text.find(R"("recording": null)"), std::string::npos) << text;
  EXPECT_NE(text.find(R"("ending": "node x died")"), std::string::npos) << text;
  EXPECT_NE(text.find(R"("time_s": 1.5)"), std::string::npos) << text;
}

}  // namespace
}  // namespace rths::session
