// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <rths/controller/vertical_force.hpp>
#include <rths/core/error.hpp>

#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

/// A spring behind a first-order displacement loop.
struct SpringAxis {
  double stiffness = 4e9, lag = 0.05, x = 0;
  double operator()(double reference) {
    x += kPeriod / lag * (reference - x);
    return stiffness * x;
  }
};

TEST(ForceCascade, ReachesAForceThoughItsStiffnessIsWrong) {
  ForceCascade cascade{{}};  // assumes 5 GN/m, the spring has 4
  SpringAxis axis;
  double force = 0;

  for (int i = 0; i < 3000; ++i) force = axis(cascade.step(2e6, force));

  // An integrator with 15/s × 4/5: after 3 s the rest is exp(−36).
  EXPECT_NEAR(force, 2e6, 1);
}

TEST(ForceCascade, HoldsItsReferenceOnBadFeedback) {
  ForceCascade cascade{{}};
  const double before = cascade.step(1e6, 0);

  EXPECT_EQ(cascade.step(1e6, std::numeric_limits<double>::quiet_NaN()), before);
  EXPECT_EQ(cascade.step(std::numeric_limits<double>::infinity(), 0), before);
}

TEST(AxialBearing, AddsFlexibilitiesAndTheHeightChange) {
  const AxialBearing bearing{.stiffness = 5e9,
                             .softening = 25,
                             .lift_radius = 10,
                             .servo_stiffness = 50e9,
                             .series_stiffness = 1e9};

  // u = 0.2 m: K = 5/(1 + 25·0.04) = 2.5 GN/m; height 0.04/20 = 2 mm.
  EXPECT_DOUBLE_EQ(bearing.displacement(1e6, 0.2), 1e6 * (1 / 2.5e9 + 1 / 50e9 + 1 / 1e9) + 2e-3);
  EXPECT_DOUBLE_EQ(bearing.displacement(0, -0.2), 2e-3);
}

TEST(VerticalForceControl, FollowsTheHeightChangeOfTheBearing) {
  VerticalForceSettings settings = srmd_vertical();
  settings.bearing.lift_radius = 10;
  VerticalForceControl control{settings};
  double reference = 0;

  for (int i = 0; i < 200; ++i) reference = control.step(0, 0, 0.2, 0.2, false);

  EXPECT_NEAR(reference, 2e-3, 1e-9);
}

TEST(VerticalForceControl, RemovesASteadyDisturbance) {
  VerticalForceControl control{srmd_vertical()};
  SpringAxis axis;  // 4 GN/m instead of 5
  double force = 0;

  for (int i = 0; i < 4000; ++i) force = axis(control.step(2e6, force, 0, 0, false));

  EXPECT_NEAR(force, 2e6, 2e3);
  EXPECT_NE(control.disturbance(), 0);
}

TEST(VerticalForceControl, KeepsItsReferenceFiniteOnBadFeedback) {
  VerticalForceControl control{srmd_vertical()};

  for (int i = 0; i < 100; ++i)
    EXPECT_TRUE(
        std::isfinite(control.step(1e6, std::numeric_limits<double>::quiet_NaN(), 0.1, 0.1)));

  EXPECT_EQ(control.inverse().bad_samples(), 100);
  EXPECT_EQ(control.disturbance(), 0);
}

TEST(VerticalForceControl, RefusesSettingsOutOfRange) {
  VerticalForceSettings settings = srmd_vertical();
  settings.bearing.stiffness = 0;
  EXPECT_THROW(VerticalForceControl{settings}, Error);
  EXPECT_THROW((ForceCascade{{.gain = 0}}), Error);
}

TEST(VerticalForceControl, WorksInRealTime) {
  VerticalForceControl control{srmd_vertical()};
  ForceCascade cascade{{}};

  EXPECT_REALTIME((void)control.step(1e6, 1e6, 0.1, 0.1));
  EXPECT_REALTIME((void)cascade.step(1e6, 1e6));
}

}  // namespace
}  // namespace rths::controller
