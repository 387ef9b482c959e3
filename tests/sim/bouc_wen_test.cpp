// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <rths/sim/bearing.hpp>

#include "support/lead_rubber.hpp"
#include "support/realtime_guard.hpp"

namespace rths::sim {
namespace {

using Eigen::Vector2d;

constexpr double kAnyStep = 1e-3;  // [s]; the results do not depend on time

// The paper's bearing: 1,900 kN at 210 mm from a strength of 1,010 kN.
TEST(BoucWen, HasThePapersForceAtItsDesignDisplacement) {
  BearingRun bearing{test::plain_lead_rubber(), kAnyStep};
  Vector2d force = Vector2d::Zero();
  for (int i = 1; i <= 210; ++i) force = test::moved(bearing, {i * 1e-3, 0});

  EXPECT_NEAR(force[0], 1.900e6, 1e3);
  EXPECT_EQ(force[1], 0);
}

// Loaded along a line, dz = (1 − z²)du/u_y for β + γ = 1 and η = 2: z = tanh(u/u_y).
TEST(BoucWen, YieldsAlongATanhWhenLoadedAlongALine) {
  BearingRun bearing{test::plain_lead_rubber(), kAnyStep};
  for (int i = 1; i <= 100; ++i) {
    const double u = i * 1e-4;
    const Vector2d force = test::moved(bearing, {u, 0});
    const double expected =
        test::kPostYieldStiffness * u + test::kStrength * std::tanh(u / test::kYieldDisplacement);
    EXPECT_NEAR(force[0], expected, 1e-6 * test::kStrength);
  }
}

TEST(BoucWen, StartsWithItsInitialStiffness) {
  BearingRun bearing{test::plain_lead_rubber(), kAnyStep};
  const double u = 1e-7;

  EXPECT_NEAR(test::moved(bearing, {u, 0})[0] / u, test::kInitialStiffness,
              1e-5 * test::kInitialStiffness);
}

TEST(BoucWen, DoesNotDependOnTheChoiceOfAxes) {
  BearingRun straight{test::plain_lead_rubber(), kAnyStep};
  BearingRun turned{test::plain_lead_rubber(), kAnyStep};
  const double angle = 0.7;
  const Eigen::Matrix2d R =
      (Eigen::Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle))
          .finished();
  for (int i = 0; i < 2000; ++i) {
    const double t = i * 0.005;
    const Vector2d u{0.1 * std::sin(3 * t), 0.06 * std::sin(4.1 * t + 0.4)};
    const Vector2d force = R * test::moved(straight, u);
    const Vector2d turned_force = test::moved(turned, R * u);
    EXPECT_NEAR((force - turned_force).norm(), 0, 1e-6 * test::kStrength);
  }
}

TEST(BoucWen, SharesItsStrengthBetweenTheAxes) {
  BearingRun bearing{test::plain_lead_rubber(), kAnyStep};
  std::mt19937 random{4};
  std::normal_distribution<double> step{0, 0.004};
  Vector2d u = Vector2d::Zero();
  for (int i = 0; i < 5000; ++i) {
    u += Vector2d{step(random), step(random)};
    const Vector2d force = test::moved(bearing, u);
    const Vector2d plug = force - test::kPostYieldStiffness * u;
    EXPECT_LE(plug.norm(), test::kStrength * (1 + 1e-12));
  }
}

TEST(BoucWen, NeverReturnsMoreEnergyThanItAbsorbed) {
  std::mt19937 random{6};
  std::normal_distribution<double> step{0, 0.002};
  for (int path = 0; path < 20; ++path) {
    BearingRun bearing{test::plain_lead_rubber(), kAnyStep};
    Vector2d u = Vector2d::Zero();
    Vector2d before = Vector2d::Zero();
    double work = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vector2d du{step(random), step(random)};
      u += du;
      const Vector2d force = test::moved(bearing, u);
      work += 0.5 * (force + before).dot(du);
      before = force;
    }
    const double stored = 0.5 * test::kPostYieldStiffness * u.squaredNorm();
    EXPECT_GE(work, stored);
  }
}

// Smaller increments give the same path up to the error of the internal Runge-Kutta steps.
TEST(BoucWen, HardlyDependsOnTheSizeOfTheIncrements) {
  BearingRun coarse{test::plain_lead_rubber(), kAnyStep};
  BearingRun fine{test::plain_lead_rubber(), kAnyStep};
  Vector2d coarse_force = Vector2d::Zero();
  Vector2d fine_force = Vector2d::Zero();
  for (int i = 1; i <= 100; ++i) {
    coarse_force = test::moved(coarse, {0.002 * i, 0.001 * i});
    for (int quarter = 1; quarter <= 4; ++quarter) {
      const double at = i - 1 + quarter / 4.0;
      fine_force = test::moved(fine, {0.002 * at, 0.001 * at});
    }
  }

  EXPECT_NEAR((coarse_force - fine_force).norm(), 0, 1e-4 * test::kStrength);
}

TEST(BoucWen, StandsStillWithoutMotion) {
  BearingRun bearing{test::plain_lead_rubber(), kAnyStep};
  const Vector2d once = test::moved(bearing, {0.05, 0.02});

  EXPECT_EQ(test::moved(bearing, {0.05, 0.02}), once);
}

TEST(BoucWen, AdvancesInRealTime) {
  BearingRun bearing{test::plain_lead_rubber(), kAnyStep};
  Vector2d force = Vector2d::Zero();
  EXPECT_REALTIME(force = test::moved(bearing, {0.1, 0.1}));
  EXPECT_TRUE(force.allFinite());
}

}  // namespace
}  // namespace rths::sim
