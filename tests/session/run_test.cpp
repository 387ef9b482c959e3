// SPDX-License-Identifier: Apache-2.0
#include <rths/session/run.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "support/files.hpp"
#include "support/json.hpp"

namespace rths::session {
namespace {

using test::json_of;

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

// A target in every tick, without prediction in between, against targets of 10 ms. The simulation
// has the specimen's heating, too.
TEST_F(Run, HasFloorSpectraCloserToTheReferenceWithATargetInEveryTick) {
  settings.changes = {
      {"duration_s", "12"}, {"rest_s", "0.5"}, {"model.specimen.lead_heating.enabled", "true"}};
  const auto largest_difference = [&] {
    EXPECT_EQ(run(settings, progress).ending(), "completed");
    const auto report = json_of(settings.out / "report.json");
    EXPECT_EQ(report.at("slow_downs").get<int>(), 0);
    double largest = 0;
    for (const auto& floor : report.at("floors"))
      for (const auto& band : floor.at("hybrid_over_numerical"))
        largest = std::max(largest, std::abs(band.get<double>() - 1));
    return largest;
  };
  const double usual = largest_difference();
  settings.out = temporary.path() / "every tick";
  settings.changes.insert(settings.changes.end(), {{"integration_step_s", "0.001"},
                                                   {"solver.substeps", "1"},
                                                   {"solver.computing_time_s", "0.0003"},
                                                   {"node.opf.handshake", "numbered"}});
  const double found = largest_difference();

  EXPECT_EQ(json_of(settings.out / "report.json").at("integration_steps").get<int>(), 12'000);
  EXPECT_LT(found, 0.5 * usual);
  RecordProperty("percent", std::to_string(100 * found));
  RecordProperty("percent_of_10_ms", std::to_string(100 * usual));
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
