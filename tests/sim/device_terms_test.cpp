// SPDX-License-Identifier: Apache-2.0
// Devices against closed forms: friction with play and current-controlled dampers.
#include <cmath>

#include <gtest/gtest.h>

#include "sim/stepper.hpp"

namespace rths::sim {
namespace {

using test_support::Stepper;
using test_support::Values;

constexpr double kForward = 10e3, kBackward = 17e3, kForwardLength = 5e-3, kBackwardLength = 4e-3,
                 kPlay = 6e-3;

Stepper device() {
  return Stepper{{{"asymmetric_hysteresis",
                   "",
                   {{"forward_force", kForward},
                    {"backward_force", kBackward},
                    {"forward_length", kForwardLength},
                    {"backward_length", kBackwardLength},
                    {"play", kPlay}}}},
                 1e-3};
}

TEST(AsymmetricHysteresis, PlaysThenStretchesThenSlips) {
  auto friction = device();

  EXPECT_EQ(friction.walk(0, 0.5 * kPlay, 10).force[0], 0);
  const double stretched = 0.5 * kPlay + 0.4 * kForwardLength;
  EXPECT_NEAR(friction.walk(0.5 * kPlay, stretched, 10).force[0], 0.4 * kForward, 1e-9 * kForward);
  EXPECT_NEAR(friction.walk(stretched, 0.05, 10).force[0], kForward, 1e-9 * kForward);
  // Back through the elastic length, the play and half of the other side's elastic length.
  const double back = 0.05 - kForwardLength - kPlay;
  EXPECT_NEAR(friction.walk(0.05, back, 10).force[0], 0, 1e-9 * kForward);
  EXPECT_NEAR(friction.to(back - 0.5 * kBackwardLength).force[0], -0.5 * kBackward,
              1e-9 * kBackward);
}

// Each half cycle slips over 2A minus the elastic lengths and the play.
TEST(AsymmetricHysteresis, DissipatesTheAreaOfItsLoop) {
  auto friction = device();
  const double a = 0.04;
  const int steps = 2000;
  double work = 0, last = friction.walk(0, a, steps).force[0];

  for (const double end : {-a, a}) {
    for (int i = 1; i <= steps; ++i) {
      const double force = friction.to(-end + 2 * end * i / steps).force[0];
      work += 0.5 * (force + last) * 2 * end / steps;
      last = force;
    }
  }

  const double slip = 2 * a - kForwardLength - kBackwardLength - kPlay;
  EXPECT_NEAR(work, (kForward + kBackward) * slip, 1e-4 * work);
}

// Steady sliding at a speed, until presliding has ended.
double sliding_force(const TermSettings& term, double current, double speed) {
  Stepper stepper{{term}, 1e-2};
  Quantities<double> q;
  for (int i = 1; i <= 100; ++i) {
    Quantities<double> given;
    given.displacement[0] = speed * 1e-2 * i;
    given.velocity[0] = speed;
    given.auxiliary = current;
    q = stepper.step(given);
  }
  return q.force[0];
}

TEST(CurrentDependentFriction, FollowsTheCurrentAndCreepsAtLowSpeed) {
  const TermSettings term{"current_dependent_friction",
                          "",
                          {{"friction_force", 100},
                           {"force_per_current", 1200},
                           {"force_per_current2", -200},
                           {"presliding", 2e-4},
                           {"creep_velocity", 5e-3}}};

  EXPECT_NEAR(sliding_force(term, 0, 0.095), 100 * 0.95, 1e-6);
  EXPECT_NEAR(sliding_force(term, 1, 0.095), 1100 * 0.95, 1e-6);
  EXPECT_NEAR(sliding_force(term, 1, -5e-3), -1100 * 0.5, 1e-6);
  EXPECT_EQ(sliding_force(term, -1, 0.1), 0) << "friction is never negative";
}

// The force at unit velocity is the current as the device has it: a step of 1 A at t = 0.1 s.
std::vector<double> answer_to_step(const TermSettings& term) {
  const double dt = 1e-3;
  Stepper stepper{{term, {"current_dependent_damping", "", {{"coefficient_per_current", 1}}}}, dt};
  std::vector<double> answer;
  for (int i = 0; i < 300; ++i) {
    Quantities<double> given;
    given.velocity[0] = 1;
    given.auxiliary = i < 100 ? 0 : 1;
    answer.push_back(stepper.step(given).force[0]);
  }
  return answer;
}

// Of a ramp from 0 to 1 within one step, then 1: y = 1 - T/dt (e^(dt/T) - 1) e^(-t/T).
TEST(ControlLag, FollowsTheCurrentExponentially) {
  const double lag = 0.02, dt = 1e-3;
  const auto answer = answer_to_step({"control_lag", "", {{"time_constant", lag}}});

  EXPECT_EQ(answer[99], 0);
  for (const int i : {100, 120, 200}) {
    const double t = (i - 99) * dt;
    const double expected = 1 - lag / dt * std::expm1(dt / lag) * std::exp(-t / lag);
    EXPECT_NEAR(answer[static_cast<std::size_t>(i)], expected, 1e-9) << i;
  }
}

TEST(ControlDelay, ShiftsTheCurrent) {
  const auto answer = answer_to_step({"control_delay", "", {{"delay", 0.03}}});

  EXPECT_EQ(answer[129], 0);
  EXPECT_EQ(answer[130], 1);
}

TEST(CurrentDependentDamping, FollowsTheCurrent) {
  const TermSettings term{"current_dependent_damping",
                          "",
                          {{"coefficient", 1000},
                           {"coefficient_per_current", 9000},
                           {"coefficient_per_current2", -1000}}};

  EXPECT_NEAR(sliding_force(term, 0.5, 0.2), 0.2 * 5250, 1e-9);
  EXPECT_EQ(sliding_force(term, -1, 0.2), 0);
}

}  // namespace
}  // namespace rths::sim
