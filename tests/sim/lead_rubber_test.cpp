// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/sim/lead_rubber.hpp>

#include "support/realtime_guard.hpp"

namespace rths::sim {
namespace {

using Eigen::Vector2d;

constexpr double kDesignDisplacement = 0.210;  // the paper's LPRB [m]

// The paper's bearing: 1,900 kN at 210 mm from a strength of 1,010 kN.
TEST(LeadRubber, HasThePapersForceAtItsDesignDisplacement) {
  const LeadRubber bearing;
  LeadRubberState state;
  Vector2d force = Vector2d::Zero();
  for (int i = 1; i <= 210; ++i) force = advance(bearing, state, {i * 1e-3, 0});

  EXPECT_NEAR(force[0], 1.900e6, 1e3);
  EXPECT_EQ(force[1], 0);
}

// Loaded along a line, dz = (1 − z²)du/u_y for β + γ = 1 and η = 2: z = tanh(u/u_y).
TEST(LeadRubber, YieldsAlongATanhWhenLoadedAlongALine) {
  const LeadRubber bearing;
  LeadRubberState state;
  for (int i = 1; i <= 100; ++i) {
    const double u = i * 1e-4;
    const Vector2d force = advance(bearing, state, {u, 0});
    const double expected =
        bearing.post_yield_stiffness * u +
        bearing.characteristic_strength * std::tanh(u / bearing.yield_displacement());
    EXPECT_NEAR(force[0], expected, 1e-6 * bearing.characteristic_strength);
  }
}

TEST(LeadRubber, StartsWithItsInitialStiffness) {
  const LeadRubber bearing;
  LeadRubberState state;
  const double u = 1e-7;

  EXPECT_NEAR(advance(bearing, state, {u, 0})[0] / u, bearing.initial_stiffness,
              1e-5 * bearing.initial_stiffness);
}

// A full cycle between ±D dissipates 4 Q (D − u_y ln 2·…): for z = tanh the corners cost about
// u_y each, so the energy lies between 4Q(D − 2u_y) and 4QD.
TEST(LeadRubber, DissipatesTheEnergyOfItsStrength) {
  const LeadRubber bearing;
  LeadRubberState state;
  const double D = kDesignDisplacement;
  const int steps = 4000;
  double energy = 0;
  double before = 0;
  double force_before = 0;
  for (int i = 1; i <= 2 * steps; ++i) {
    const double u = D * std::sin(2 * std::numbers::pi * i / steps);
    const double force = advance(bearing, state, {u, 0})[0];
    if (i > steps) energy += 0.5 * (force + force_before) * (u - before);
    before = u;
    force_before = force;
  }

  const double Q = bearing.characteristic_strength;
  EXPECT_LT(energy, 4 * Q * D);
  EXPECT_GT(energy, 4 * Q * (D - 2 * bearing.yield_displacement()));
}

TEST(LeadRubber, DoesNotDependOnTheChoiceOfAxes) {
  const LeadRubber bearing;
  LeadRubberState straight;
  LeadRubberState turned;
  const double angle = 0.7;
  const Eigen::Matrix2d R =
      (Eigen::Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle))
          .finished();
  for (int i = 0; i < 2000; ++i) {
    const double t = i * 0.005;
    const Vector2d u{0.1 * std::sin(3 * t), 0.06 * std::sin(4.1 * t + 0.4)};
    const Vector2d force = R * advance(bearing, straight, u);
    const Vector2d turned_force = advance(bearing, turned, R * u);
    EXPECT_NEAR((force - turned_force).norm(), 0, 1e-6 * bearing.characteristic_strength);
  }
}

TEST(LeadRubber, SharesItsStrengthBetweenTheAxes) {
  const LeadRubber bearing;
  LeadRubberState state;
  std::mt19937 random{4};
  std::normal_distribution<double> step{0, 0.004};
  Vector2d u = Vector2d::Zero();
  for (int i = 0; i < 5000; ++i) {
    u += Vector2d{step(random), step(random)};
    const Vector2d force = advance(bearing, state, u);
    const Vector2d plug = force - bearing.post_yield_stiffness * u;
    EXPECT_LE(plug.norm(), bearing.characteristic_strength * (1 + 1e-12));
  }
}

TEST(LeadRubber, NeverGivesOutMoreEnergyThanItTook) {
  const LeadRubber bearing;
  std::mt19937 random{6};
  std::normal_distribution<double> step{0, 0.002};
  for (int path = 0; path < 20; ++path) {
    LeadRubberState state;
    Vector2d u = Vector2d::Zero();
    Vector2d before = Vector2d::Zero();
    double work = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vector2d du{step(random), step(random)};
      u += du;
      const Vector2d force = advance(bearing, state, u);
      work += 0.5 * (force + before).dot(du);
      before = force;
    }
    const double stored = 0.5 * bearing.post_yield_stiffness * u.squaredNorm();
    EXPECT_GE(work, stored);
  }
}

// Half the increments give the same path to the order of the Runge-Kutta steps inside.
TEST(LeadRubber, HardlyDependsOnTheSizeOfTheIncrements) {
  const LeadRubber bearing;
  LeadRubberState coarse;
  LeadRubberState fine;
  Vector2d coarse_force = Vector2d::Zero();
  Vector2d fine_force = Vector2d::Zero();
  for (int i = 1; i <= 100; ++i) {
    coarse_force = advance(bearing, coarse, {0.002 * i, 0.001 * i});
    for (int part = 1; part <= 4; ++part) {
      const double at = i - 1 + part / 4.0;
      fine_force = advance(bearing, fine, {0.002 * at, 0.001 * at});
    }
  }

  EXPECT_NEAR((coarse_force - fine_force).norm(), 0, 1e-4 * bearing.characteristic_strength);
}

TEST(LeadRubber, StandsStillWithoutMotion) {
  const LeadRubber bearing;
  LeadRubberState state;
  const Vector2d once = advance(bearing, state, {0.05, 0.02});

  EXPECT_EQ(advance(bearing, state, {0.05, 0.02}), once);
}

TEST(LeadRubber, AdvancesInRealTime) {
  const LeadRubber bearing;
  LeadRubberState state;
  Vector2d force = Vector2d::Zero();
  EXPECT_REALTIME(force = advance(bearing, state, state.displacement + Vector2d{0.1, 0.1}));
  EXPECT_TRUE(force.allFinite());
}

}  // namespace
}  // namespace rths::sim
