// SPDX-License-Identifier: Apache-2.0
//
// Runs in virtual time, compared.
#include <algorithm>

#include <gtest/gtest.h>

#include <rths/report/comparison.hpp>
#include <rths/session/run.hpp>

#include "support/files.hpp"

namespace rths::session {
namespace {

class ComparedVirtualRuns : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& name, const experiment::Overrides& changes) {
    RunSettings settings;
    settings.experiment = test::source_tree() / "examples/srmd_lprb_2d.toml";
    settings.changes = {{"duration_s", "3"}, {"rest_s", "0.5"}};
    settings.changes.insert(settings.changes.end(), changes.begin(), changes.end());
    settings.clock = launch::ClockKind::Virtual;
    settings.out = temporary_.path() / name;
    settings.diagnoses = false;
    static_cast<void>(run(settings, {}));
    return settings.out / report::kRunFile;
  }

  const test::TemporaryFolder temporary_;
};

TEST_F(ComparedVirtualRuns, AreEqualIfTheyHaveTheSameSettings) {
  const auto found = report::compare(made("a", {}), made("b", {}), {});

  EXPECT_GT(found.signals.size(), 100U);
  EXPECT_EQ(found.equal(), found.signals.size());
  EXPECT_TRUE(found.settings.empty());
}

TEST_F(ComparedVirtualRuns, NameTheSettingThatDiffers) {
  const auto found = report::compare(made("a", {}), made("b", {{"motion.scale", "1.2"}}), {});

  ASSERT_EQ(found.settings.size(), 1U);
  EXPECT_EQ(found.settings[0].key, "motion.scale");
  EXPECT_EQ(found.settings[0].baseline, "1.4");
  EXPECT_EQ(found.settings[0].other, "1.2");
  EXPECT_LT(found.equal(), found.signals.size());
  const auto ground = std::find_if(found.signals.begin(), found.signals.end(), [](const auto& one) {
    return one.name == "monitor.opf.ground.accel.long";
  });
  ASSERT_NE(ground, found.signals.end());
  EXPECT_EQ(ground->explanation, "is 0.8571 times the baseline");
}

}  // namespace
}  // namespace rths::session
