// SPDX-License-Identifier: Apache-2.0
// Sensor terms against closed forms.
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "sim/stepper.hpp"

namespace rths::sim {
namespace {

using test_support::kStep;
using test_support::Stepper;
using test_support::Values;

TermSettings on(SensorChannel channel, const std::string& kind, const Values& values,
                unsigned axes = kBothAxes) {
  return {kind, "", values, axes, channel};
}

Quantities<double> readings(double x) {
  Quantities<double> q;
  q.displacement = q.acceleration = {x, -x};
  q.axial_load = x;
  return q;
}

double read(const TermSettings& sensor, double x) {
  return Stepper{{sensor}, kStep}.step(readings(x)).displacement[0];
}

TEST(SensorTerms, ActOnTheirChannelAndAxesOnly) {
  Stepper sensor{{on(SensorChannel::Acceleration, "offset", {{"offset", 0.5}}, 0b10)}, kStep};

  const auto q = sensor.step(readings(1));

  EXPECT_EQ(q.acceleration, (Horizontal<double>{1, -0.5}));
  EXPECT_EQ(q.displacement, (Horizontal<double>{1, -1}));
  EXPECT_EQ(q.axial_load, 1);
}

TEST(SensorTerms, ActOnTheAxialLoad) {
  Stepper sensor{{on(SensorChannel::AxialLoad, "gain", {{"factor", 1.5}})}, kStep};
  EXPECT_EQ(sensor.step(readings(2)).axial_load, 3);
}

TEST(SensorTerms, HaveParametersInTheUnitOfTheirChannel) {
  const auto& drift = term_kind("drift").parameters[0];
  EXPECT_EQ(parameter_key(drift, SensorChannel::Force), "rate_N_per_s");
  EXPECT_EQ(parameter_key(drift, SensorChannel::Displacement), "rate_m_per_s");
}

TEST(Drift, StartsAtTheFirstStepForAnyOriginOfTime) {
  Composition sensor{{on(SensorChannel::Displacement, "drift", {{"rate", 2}})}, kStep};
  std::vector<double> state(sensor.states());
  Quantities<double> q;
  for (const double time : {1000.0, 1003.0}) {
    q = {};
    q.time = time;
    sensor.advance(state, q);
  }
  EXPECT_NEAR(q.displacement[0], 6, 1e-12);
}

TEST(Quantisation, RoundsToTheNearestLevel) {
  const double step = 0.25;
  for (double x = -2; x < 2; x += 0.0137) {
    const double y = read(on(SensorChannel::Displacement, "quantisation", {{"step", step}}), x);
    EXPECT_EQ(std::remainder(y, step), 0);
    EXPECT_LE(std::abs(y - x), step / 2);
  }
}

TEST(Ranges, ClipOrWrapAround) {
  EXPECT_EQ(read(on(SensorChannel::Displacement, "saturation", {{"limit", 2}}), 3), 2);
  EXPECT_EQ(read(on(SensorChannel::Displacement, "saturation", {{"limit", 2}}), -3), -2);
  EXPECT_EQ(read(on(SensorChannel::Displacement, "overflow", {{"limit", 2}}), 3), -1);
  EXPECT_EQ(read(on(SensorChannel::Displacement, "overflow", {{"limit", 2}}), -3), 1);
  EXPECT_EQ(read(on(SensorChannel::Displacement, "overflow", {{"limit", 2}}), 1.5), 1.5);
}

TEST(Scales, DistortReadings) {
  EXPECT_EQ(read(on(SensorChannel::Displacement, "absolute_value_sensor", {{"share", 1}}), -3), 3);
  EXPECT_NEAR(
      read(on(SensorChannel::Displacement, "cubic_distortion", {{"share", 0.1}, {"range", 2}}), -4),
      -4 * 1.4, 1e-12);
}

// Cubic interpolation and a filter in steady state both delay a ramp exactly.
TEST(Lateness, DelaysARamp) {
  Stepper skew{{on(SensorChannel::Displacement, "time_skew", {{"skew", 0.0123}})}, kStep};
  Stepper filter{{on(SensorChannel::Displacement, "filter_lag", {{"time_constant", 0.01}})}, kStep};
  for (int i = 0; i < 1000; ++i) {
    const double t = kStep * i;
    const double late = skew.step(readings(t)).displacement[0];
    const double filtered = filter.step(readings(t)).displacement[0];
    ASSERT_NEAR(filtered, t - 0.01 * (1 - std::exp(-t / 0.01)), 1e-12);
    if (i <= 15) continue;
    ASSERT_NEAR(late, t - 0.0123, 1e-12);
  }
}

// At 4 ms and 10 Hz, a lag of 1 ms differs from a delay by 2e-3. A line within each step would err
// by twice as much.
TEST(Lateness, OfAFilterIsExactForASineOfSmallSteps) {
  constexpr double kCoarse = 4e-3, kFrequency = 2 * std::numbers::pi * 10;
  for (const double lag : {2e-4, 1e-3, 4e-3, 0.0399, 0.0401, 0.5}) {
    Stepper filter{{on(SensorChannel::Displacement, "filter_lag", {{"time_constant", lag}})},
                   kCoarse};
    const std::complex<double> gain = 1.0 / std::complex{1.0, kFrequency * lag};
    for (int i = 0; i < 2000; ++i) {
      const double t = kCoarse * i;
      const double filtered = filter.step(readings(std::sin(kFrequency * t))).displacement[0];
      if (t < 10 * lag + 0.1) continue;
      const std::complex<double> exact = gain * std::polar(1.0, kFrequency * t);
      ASSERT_NEAR(filtered, exact.imag(), 2e-4) << lag;
    }
  }
}

TEST(ClockDrift, IsTenMillisecondsAfterAHundredSecondsAtAHundredPartsPerMillion) {
  Stepper sensor{
      {on(SensorChannel::Displacement, "clock_drift", {{"skew", 0.002}, {"rate", 1e-4}})}, kStep};
  double late = 0;
  for (int i = 0; i <= 100'000; ++i)
    late = kStep * i - sensor.step(readings(kStep * i)).displacement[0];

  EXPECT_NEAR(late, 0.012, 1e-9);
}

TEST(ClockDrift, NeverReportsFutureValues) {
  Stepper sensor{{on(SensorChannel::Displacement, "clock_drift", {{"rate", -0.01}})}, kStep};
  for (int i = 0; i < 1000; ++i) ASSERT_NEAR(sensor.step(readings(i)).displacement[0], i, 1e-9);
}

TEST(Crosstalk, AddsSharesOfTheOtherAxes) {
  Stepper sensor{{on(SensorChannel::Acceleration, "crosstalk_horizontal",
                     {{"lat_into_long", 0.1}, {"long_into_lat", 0.2}})},
                 kStep};
  const auto q = sensor.step(readings(1));
  EXPECT_NEAR(q.acceleration[0], 1 - 0.1, 1e-15);
  EXPECT_NEAR(q.acceleration[1], -1 + 0.2, 1e-15);

  Stepper cell{{{"crosstalk_vertical", "", {{"share", 0.01}, {"reference_load", 3}}}}, kStep};
  EXPECT_NEAR(cell.step(readings(10)).force[0], 0.07, 1e-15);
}

TEST(AccelerometerTilt, AddsGravity) {
  Stepper sensor{{{"accelerometer_tilt", "", {{"tilt", 0.01}, {"tilt_per_displacement", 0.1}}}},
                 kStep};
  Quantities<double> q;
  q.displacement = {0.2, 0};

  EXPECT_NEAR(sensor.step(q).acceleration[0], 9.80665 * 0.03, 1e-12);
}

}  // namespace
}  // namespace rths::sim
