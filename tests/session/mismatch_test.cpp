// SPDX-License-Identifier: Apache-2.0
//
// The virtual laboratory reproduces two mismatches between test and simulation seen at the SRMD:
// their effect on floor spectra, and their diagnosis.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/json.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"

namespace rths::launch {
namespace {

using Json = nlohmann::json;
using test::json_of;

/// A run of an example in virtual time, in its own folder.
class Mismatch {
 public:
  explicit Mismatch(const std::string& example, const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments{
        "run",     (test::source_tree() / "examples" / example).string(),
        "--clock", "virtual",
        "--out",   folder_.path().string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    constexpr int kSeconds = 300;  // with its diagnosis, while other tests share the processors
    const auto run = test::run_rths(arguments, kSeconds);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  [[nodiscard]] Json report() const { return json_of(folder_.path() / "report.json"); }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return folder_.path() / name;
  }

 private:
  test::TemporaryFolder folder_;
};

/// Ratio of the test's spectrum to the simulation's, one per floor.
std::vector<double> ratios(const Json& report, const char* of, const char* band) {
  std::vector<double> values;
  for (const auto& floor : report["floors"]) values.push_back(floor[of][band]);
  EXPECT_EQ(values.size(), 3U);
  return values;
}
double lowest(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}
double highest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

bool blames(const Json& verdict, const std::string& part) {
  const auto& causes = verdict["causes"];
  return verdict["where"]["part"] == part ||
         std::any_of(causes.begin(), causes.end(),
                     [&](const Json& cause) { return cause["part"] == part; });
}

// A lead of 80 ms on a lag of 60 ms has the linear gain (1 + 0.08 iω)/(1 + 0.06 iω): 1.30 at the
// auxiliary building's 7.6 Hz, and more in closed loop. A well compensated machine changes these
// spectra by up to 10 %.
constexpr double kTooHigh = 1.3, kLeftWhenTracked = 1.15;

TEST(DetunedTracking, RaisesFloorSpectraAbove6HzInRealTimeOnly) {
  const Json fast = Mismatch{"mismatch_tracking_2d.toml", {"--no-diagnosis"}}.report();
  const Json slow =
      Mismatch{"mismatch_tracking_2d.toml", {"--no-diagnosis", "--set", "rate=2"}}.report();

  EXPECT_GT(lowest(ratios(fast, "hybrid_over_numerical", "6_to_11_Hz")), kTooHigh);
  EXPECT_LT(highest(ratios(slow, "hybrid_over_numerical", "6_to_11_Hz")), kLeftWhenTracked);
  EXPECT_GT(lowest(ratios(slow, "hybrid_over_numerical", "6_to_11_Hz")), 1 / kLeftWhenTracked);
  for (const Json& report : {fast, slow}) {
    EXPECT_LT(highest(ratios(report, "hybrid_over_numerical", "below_6_Hz")), 1.1);
    EXPECT_GT(lowest(ratios(report, "hybrid_over_numerical", "below_6_Hz")), 0.9);
  }
}

TEST(DetunedTracking, IsBlamedOnTheMachineAndNotOnTheBearing) {
  const Mismatch run{
      "mismatch_tracking_2d.toml",
      {"--set", test::is_long() ? "duration_s=20" : "duration_s=10", "--set", "uncompensated={}"}};
  const Json verdict = json_of(run.file("verdict.json"));

  EXPECT_EQ(verdict["verdict"], "missing");
  ASSERT_EQ(verdict["causes"].size(), 1U) << verdict["sentence"];
  EXPECT_EQ(verdict["causes"][0]["name"], "transfer_system");
  EXPECT_EQ(verdict["where"]["part"], "actuator") << verdict["sentence"];
  EXPECT_EQ(verdict["where"]["channel"], "displacement") << verdict["sentence"];
  EXPECT_FALSE(blames(verdict, "bearing")) << verdict["sentence"];
  ASSERT_EQ(verdict["budget"]["axes"].size(), 2U);
  for (const auto& axis : verdict["budget"]["axes"]) {
    EXPECT_GT(axis["tracking_nrms"], 0.05);
    EXPECT_LT(axis["held_out_nrms"], 0.01);
    // 1/K + tau of the machine: docs/theory/test_machine.md.
    EXPECT_NEAR(axis["transfer_system"]["delay_s"], 1 / 20.5 + 0.002, 0.001);
    EXPECT_GT(axis["shares"]["tracking"], 0.8);
    EXPECT_LT(axis["difference_after"], 0.03);
  }
}

TEST(VerticalCoupling, IsNamedAndClosesTheGapInFloorSpectra) {
  const Mismatch run{"mismatch_coupling.toml",
                     {"--set", test::is_long() ? "duration_s=12" : "duration_s=6"}};
  const Json verdict = json_of(run.file("verdict.json"));
  const Json report = run.report();

  EXPECT_EQ(verdict["verdict"], "missing");
  ASSERT_EQ(verdict["causes"].size(), 1U) << verdict["sentence"];
  EXPECT_EQ(verdict["causes"][0]["name"], "axial_load_strength");
  EXPECT_EQ(verdict["causes"][0]["part"], "bearing");
  const Json& found = verdict["causes"][0]["parameters"]["axial_load_strength.coefficient"];
  EXPECT_NEAR(found["value"], 1, 0.02);  // of friction
  EXPECT_LT(verdict["fit"]["held_out.h5"]["nrmse_after"],
            1.2 * verdict["fit"]["held_out.h5"]["noise_floor"].get<double>());
  // The plant's vertical resonance varies the axial load and so the friction. A simulation at
  // constant load misses this in the band around the resonance, not below it.
  const auto before = ratios(report, "hybrid_over_numerical", "6_to_11_Hz");
  const auto after = ratios(report, "hybrid_over_improved", "6_to_11_Hz");
  EXPECT_GT(lowest(before), 1.08);
  EXPECT_GT(highest(before), 1.2);
  for (std::size_t floor = 0; floor < before.size(); ++floor)
    EXPECT_LT(std::abs(std::log(after[floor])), std::log(before[floor]) / 3) << floor;
  EXPECT_LT(highest(ratios(report, "hybrid_over_numerical", "below_6_Hz")), 1.05);
}

TEST(MismatchedNothing, IsReportedAsNone) {
  // The compensation is tuned correctly, and no actuator assumption is wrong.
  const Mismatch run{"srmd_lprb_2d.toml",
                     {"--set", test::is_long() ? "duration_s=20" : "duration_s=7", "--set",
                      "uncompensated={}", "--set", "model.specimen.lead_heating.enabled=true",
                      "--set", "model.machine.load_dependent_friction.enabled=true"}};
  const Json verdict = json_of(run.file("verdict.json"));

  EXPECT_EQ(verdict["verdict"], "none") << verdict["sentence"];
  EXPECT_FALSE(std::filesystem::exists(run.file("improved.toml")));
}

}  // namespace
}  // namespace rths::launch
