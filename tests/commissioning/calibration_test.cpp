// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/commissioning/calibration.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>

namespace rths::commissioning {
namespace {

constexpr double kInterval = 0.001, kBandHz[] = {0.1, 3};

/// Sines of the whole band, with random phases, through 1/(c0 + c1 s + c2 s²): in closed form.
AxisCharacter machine_record(double c0, double c1, double c2, double noise, unsigned seed) {
  std::mt19937 random{seed};
  std::uniform_real_distribution<double> phase{0, 2 * std::numbers::pi};
  std::normal_distribution<double> normal{0, noise};
  AxisCharacter record;
  record.interval = kInterval;
  record.reference.assign(40'000, 0);
  record.displacement.assign(40'000, 0);
  for (int n = 2; n <= 140; ++n) {
    const double w = 2 * std::numbers::pi * n / 40.0, start = phase(random), size = 0.03 / n;
    const std::complex<double> response = 1.0 / std::complex<double>{c0 - c2 * w * w, c1 * w};
    for (std::size_t i = 0; i < record.reference.size(); ++i) {
      const auto turn = std::polar(size, w * kInterval * static_cast<double>(i) + start);
      record.reference[i] += turn.imag();
      record.displacement[i] += (response * turn).imag();
    }
  }
  for (double& x : record.displacement) x += normal(random);
  return record;
}

// The machine is the inverse of a lead of second order, so the fit is exact but for the leakage of
// the window: segments of 8 s of a record with lines 1/40 Hz apart.
TEST(Calibration, FindsTheLeadThatInvertsTheMachine) {
  const std::vector<AxisCharacter> records{machine_record(0.98, 0.055, 0.0011, 0, 1)};

  const auto found = calibrate_axis(records, {kBandHz[0], kBandHz[1], 0.3});

  EXPECT_NEAR(found.lead[0].value, 0.98, 2e-3);
  EXPECT_NEAR(found.lead[1].value, 0.055, 5e-4);
  EXPECT_NEAR(found.lead[2].value, 0.0011, 5e-5);
  EXPECT_LT(found.remaining, 0.01);
}

// Noise of 0.5 mm on a motion of 14 mm. A fit of the reference to measured derivatives would be
// biased. Twice the half width is four standard deviations.
TEST(Calibration, IsUnbiasedByNoiseAndStatesItsIntervals) {
  int lag = 0;
  double sum = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::vector<AxisCharacter> records{machine_record(1, 0.055, 0.0011, 5e-4, seed)};
    const auto found = calibrate_axis(records, {kBandHz[0], kBandHz[1], 0.3});
    lag += std::abs(found.lead[1].value - 0.055) < 2 * found.lead[1].half_width ? 1 : 0;
    sum += found.lead[1].value;
    EXPECT_LT(found.lead[1].half_width, 2e-3);
  }
  EXPECT_EQ(lag, 3);
  EXPECT_NEAR(sum / 3, 0.055, 5e-4);
}

TEST(Calibration, SplitsTheLagBetweenFeedForwardAndCompensator) {
  Calibration calibration;
  calibration.settings.feed_forward_share = 0.25;
  AxisCalibration axis;
  axis.lead = {{{1.02, 0}, {0.06, 0}, {0.001, 0}}};
  calibration.axes = {axis, axis};

  EXPECT_DOUBLE_EQ(calibration.velocity_gain(), 0.015);
  EXPECT_DOUBLE_EQ(calibration.initial()[1], 0.045);
  const auto toml = Config::parse(toml_of(calibration), "gains");
  EXPECT_EQ(toml.table("ats").numbers("initial").size(), 3U);
  EXPECT_NEAR(toml.table("feed_forward").number("velocity_gain_s"), 0.015, 1e-9);
}

TEST(Calibration, RefusesRecordsOfDifferentIntervals) {
  const AxisCharacter fine = machine_record(1, 0.05, 0.001, 0, 1);
  AxisCharacter coarse = fine;
  coarse.interval = 2 * kInterval;

  EXPECT_THROW((void)calibrate_axis({fine, coarse}, {kBandHz[0], kBandHz[1], 0.3}), Error);
  EXPECT_THROW((void)calibrate_axis({coarse, fine}, {kBandHz[0], kBandHz[1], 0.3}), Error);
}

TEST(Calibration, RefusesRecordsWithoutMotionInTheBand) {
  AxisCharacter still;
  still.reference.assign(20'000, 0);
  still.displacement.assign(20'000, 0);
  EXPECT_THROW((void)calibrate_axis({still}, {}), Error);
  EXPECT_THROW((void)calibrate_axis({}, {}), Error);
  const std::vector<AxisCharacter> records{machine_record(1, 0.05, 0.001, 0, 1)};
  EXPECT_THROW((void)calibrate_axis(records, {20, 30, 0.3}), Error);
}

}  // namespace
}  // namespace rths::commissioning
