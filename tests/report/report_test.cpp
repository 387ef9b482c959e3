// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <rths/maths/bands.hpp>
#include <rths/report/report.hpp>

#include "report/src/numbers.hpp"
#include "support/files.hpp"

namespace rths::report {
namespace {

/// A run of a thousand steps, some of them excused.
Analysis run_with(int excused) {
  Analysis analysis;
  analysis.test.name = "x";
  AxisAnalysis axis;
  axis.name = "long";
  axis.raw_delay = 0.06;
  axis.delay = 0.005;
  axis.nrms = 0.0075;
  axis.peak_displacement = 0.2;
  axis.peak_shear = 1.9e6;
  analysis.axes = {axis};
  analysis.steps.slow.assign(1000, 0.0);
  analysis.steps.predict.assign(1000, 0.003);
  analysis.steps.correct.assign(1000, 0.007);
  analysis.steps.excused_count = excused;
  analysis.hosts.late = {0, 0.01, {0.0002, 0.0043}};
  return analysis;
}

TEST(Numbers, AreInTheUnitsThatTheirKeysName) {
  const Json numbers = numbers_of(run_with(0));

  EXPECT_EQ(numbers["predict_ms_mean"], 3);
  EXPECT_EQ(numbers["correct_ms_mean"], 7);
  EXPECT_EQ(numbers["host_late_max_ms"], 4.3);
  const Json& axis = numbers["axes"]["long"];
  EXPECT_EQ(axis["delay_raw_ms"], 60);
  EXPECT_EQ(axis["delay_compensated_ms"], 5);
  EXPECT_EQ(axis["nrms_percent"], 0.75);
  EXPECT_EQ(axis["peak_displacement_mm"], 200);
  EXPECT_EQ(axis["peak_shear_kN"], 1900);
}

TEST(Numbers, HaveNoRawDelayWhereNoneWasMeasured) {
  Analysis analysis = run_with(0);
  analysis.axes[0].raw_delay.reset();

  EXPECT_TRUE(numbers_of(analysis)["axes"]["long"]["delay_raw_ms"].is_null());
}

TEST(Numbers, HoldTheDelayOfLargestMagnitudeWithItsSign) {
  Analysis analysis = run_with(0);
  analysis.axes[0].tracking.delay.values = {0.002, -0.03, std::nan(""), 0.01};

  const Json axis = numbers_of(analysis)["axes"]["long"];

  EXPECT_EQ(axis["delay_in_windows_max_ms"], -30);
  EXPECT_EQ(axis["delay_in_windows_median_ms"], 2);
  EXPECT_NE(summary_of(analysis).find("median over 2 s windows 2.0)"), std::string::npos);
}

TEST(Numbers, HaveNoDelayInWindowsWhereThereIsNoWindow) {
  const Analysis analysis = run_with(0);

  const Json axis = numbers_of(analysis)["axes"]["long"];

  EXPECT_TRUE(axis["delay_in_windows_max_ms"].is_null());
  EXPECT_TRUE(axis["delay_in_windows_median_ms"].is_null());
  EXPECT_NE(summary_of(analysis).find("median over 2 s windows –)"), std::string::npos);
}

TEST(Numbers, HoldEveryKeyOfAReport) {
  const Json numbers = numbers_of(run_with(3));

  for (const char* key :
       {"processes", "clock", "duration_s", "control_rate_hz", "overruns", "slow_downs",
        "host_late_max_ms", "steps_excused", "predict_ms_mean", "correct_ms_mean", "axes"})
    EXPECT_TRUE(numbers.contains(key)) << key;
}

// A delay of a few milliseconds says little about a closed loop.
TEST(Summary, ShowsResponseAndBandsBesideTheDelay) {
  Analysis analysis = run_with(0);
  maths::BandTracking band;
  band.from = 3;
  band.to = 6;
  band.nrms = 0.004;
  band.response = {1.16, 0.0048, 0.97};
  analysis.axes[0].bands = {band};
  NumericalAxis numerical;
  numerical.name = "long";
  numerical.difference = 0.367;
  analysis.companions.numerical = {numerical};

  const std::string summary = summary_of(analysis);
  const Json axis = numbers_of(analysis)["axes"]["long"];

  EXPECT_NE(summary.find("3 to  6 Hz: delay 4.8 ms  gain 1.160  coherence 0.97  NRMS 0.40 %"),
            std::string::npos)
      << summary;
  EXPECT_NE(summary.find("response differs by 36.7 % from the numerical result"), std::string::npos)
      << summary;
  EXPECT_EQ(axis["numerical_difference_percent"], 36.7);
  EXPECT_EQ(axis["tracking_bands"][0]["gain"], 1.16);
  EXPECT_EQ(axis["tracking_bands"][0]["delay_ms"], 4.8);
  EXPECT_EQ(axis["tracking_bands"][0]["nrms_percent"], 0.4);
}

TEST(Run, IsNotConclusiveIfAConditionIsBroken) {
  Analysis analysis = run_with(0);
  EXPECT_TRUE(is_conclusive(analysis));
  EXPECT_EQ(summary_of(analysis).find("not conclusive"), std::string::npos);

  analysis.broken = {{"force", 5.25, "srmd.long.force.fbk", "-1 times the model", "0.6 to 1.6"}};

  EXPECT_FALSE(is_conclusive(analysis));
  EXPECT_NE(summary_of(analysis).find("force at 5.250 s: srmd.long.force.fbk: found -1 times the "
                                      "model, expected 0.6 to 1.6"),
            std::string::npos);
  const Json numbers = numbers_of(analysis);
  EXPECT_EQ(numbers["conclusive"], false);
  EXPECT_EQ(numbers["broken"][0]["condition"], "force");
  EXPECT_EQ(numbers["broken"][0]["time_s"], 5.25);
  EXPECT_EQ(numbers["broken"][0]["signal"], "srmd.long.force.fbk");
}

TEST(Report, NamesTheMissingRecording) {
  const test::TemporaryFolder folder;

  EXPECT_NE(
      test::error_of([&] { static_cast<void>(make_report(folder.path(), {})); }).find("run.h5"),
      std::string::npos);
}

}  // namespace
}  // namespace rths::report
