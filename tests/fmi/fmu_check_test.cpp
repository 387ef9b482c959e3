// SPDX-License-Identifier: Apache-2.0
//
// `rths check FILE.fmu`: FMUs broken on purpose, each of which breaks exactly its rule.
#include <rths/fmi/fmu_check.hpp>

#include <gtest/gtest.h>

#include "support/realtime_guard.hpp"
#include "test_fmu.hpp"

namespace rths::fmi {
namespace {

using adapters::Finding;

struct BrokenRule {
  const char* name;
  const char* rule;
  const char* text;  ///< part of the message
  friend std::ostream& operator<<(std::ostream& out, const BrokenRule& b) { return out << b.name; }
};

class CheckOfFmu : public ::testing::TestWithParam<BrokenRule> {};

const char* const kStart = "[start]\nlevel = 0\n";

TEST_P(CheckOfFmu, FindsExactlyTheBrokenRule) {
  const BrokenRule& broken = GetParam();
  if (broken.rule == std::string{"allocation"} && !test::RealTimeGuard::supported())
    GTEST_SKIP() << "SKIPPED: sanitizers replace the heap";
  const test::TemporaryFolder folder;
  for (const int version : {2, 3}) {
    const Config config = version == 3 ? Config::parse(kStart, "config") : Config{};
    for (const auto& finding : check_fmu(test::lag_fmu(folder, version, broken.name), config)) {
      const bool is_broken = finding.rule == broken.rule;
      // An FMU that keeps its state in a static variable joins two instances too.
      if (broken.rule == std::string{"restart"} && finding.rule == "instances") continue;
      EXPECT_EQ(finding.outcome == Finding::Outcome::Fail, is_broken)
          << "FMI " << version << ": " << finding.rule << ": " << finding.text;
      if (!is_broken) continue;
      EXPECT_NE(finding.text.find(broken.text), std::string::npos) << finding.text;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fmi, CheckOfFmu,
    ::testing::Values(BrokenRule{"correct", "none", ""},
                      BrokenRule{"initialization_fails", "lifecycle", "no equilibrium"},
                      BrokenRule{"fails_step", "lifecycle", "the pump is off"},
                      BrokenRule{"refuses_step", "lifecycle", "refused the step"},
                      BrokenRule{"writes_nan", "nan", "step 100 left nan"},
                      BrokenRule{"leaves_range", "range", "stated as -1 to 1"},
                      BrokenRule{"waits", "deadline", "half of the steps"},
                      BrokenRule{"loops", "deadline", "step 100 did not return"},
                      BrokenRule{"allocates", "allocation", "step 100 used the heap 2 times"},
                      BrokenRule{"keeps_its_state", "restart", "initial state"},
                      BrokenRule{"crashes", "crash", "step 100 crashed: Segmentation fault"}));

}  // namespace
}  // namespace rths::fmi
