// SPDX-License-Identifier: Apache-2.0
// Actuator terms against closed forms: delays, transfer functions and ramps.
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "sim/stepper.hpp"

namespace rths::sim {
namespace {

using test_support::kStep;
using test_support::spring;
using test_support::Stepper;

Quantities<double> sine(double omega, double t) {
  Quantities<double> q;
  q.displacement = {std::sin(omega * t), 0};
  q.velocity = {omega * std::cos(omega * t), 0};
  q.acceleration = {-omega * omega * std::sin(omega * t), 0};
  return q;
}

// Lagrange's cubic errs by less than (ω Δt)⁴/24 in the first of its three intervals, less in the
// middle one.
TEST(ActuatorDelay, DelaysASineWithItsVelocityAndAcceleration) {
  const double omega = 2 * std::numbers::pi * 10;
  const double error = std::pow(omega * kStep, 4) / 24;
  for (const double delay : {0.0004, 0.0123, 0.1}) {
    Stepper actuator{{{"actuator_delay", "", {{"delay", delay}}}}, kStep};
    for (int i = 0; i < 500; ++i) {
      const auto q = actuator.step(sine(omega, kStep * i));
      if (i < 110) continue;
      const auto late = sine(omega, kStep * i - delay);
      ASSERT_NEAR(q.displacement[0], late.displacement[0], error);
      ASSERT_NEAR(q.velocity[0], late.velocity[0], omega * error);
      ASSERT_NEAR(q.acceleration[0], late.acceleration[0], omega * omega * error);
    }
  }
}

TEST(ActuatorDelay, ReturnsTheSampleItselfForWholeSteps) {
  Stepper actuator{{{"actuator_delay", "", {{"delay", 0.005}}}}, kStep};
  for (int i = 0; i < 500; ++i) {
    const double u = actuator.to(std::cos(1.0 * i)).displacement[0];
    ASSERT_NEAR(u, std::cos(std::max(0, i - 5)), 1e-12);
  }
}

TEST(ActuatorDelay, ReachesItsLongestDelay) {
  Stepper actuator{{{"actuator_delay", "", {{"delay", 0.2}}}}, kStep};
  for (int i = 0; i < 1000; ++i)
    ASSERT_NEAR(actuator.to(i).displacement[0], std::max(0, i - 200), 1e-9);
}

// Steady-state amplitude and phase of a sine, by projection on whole periods.
std::complex<double> response(const TermSettings& term, double frequency) {
  const double omega = 2 * std::numbers::pi * frequency;
  const int period = static_cast<int>(std::lround(1 / (frequency * kStep)));
  Stepper actuator{{term}, kStep};
  std::complex<double> sum;
  for (int i = 0; i < 40 * period; ++i) {
    const double t = kStep * i;
    const double u = actuator.step(sine(omega, t)).displacement[0];
    if (i >= 30 * period) sum += u * std::polar(1.0, -omega * t);
  }
  return sum * 2.0 / (10.0 * period) * std::complex<double>{0, 1};
}

// A command that is linear between samples lacks (ω Δt)²/12 of the sine's amplitude.
void expect_response(const TermSettings& term, double t, double lag) {
  for (const double frequency : {2.0, 10.0, 20.0}) {
    const std::complex<double> s{0, 2 * std::numbers::pi * frequency};
    const auto expected = 1.0 / (t * t * s * s + lag * s + 1.0);
    const double held = std::pow(std::abs(s) * kStep, 2) / 12;
    EXPECT_LT(std::abs(response(term, frequency) - expected),
              1.1 * held * std::abs(expected) + 1e-6)
        << term.kind << " at " << frequency;
  }
}

TEST(ActuatorLags, HaveAmplitudeAndPhaseOfTheirTransferFunctions) {
  const double t = 1 / (2 * std::numbers::pi * 12);
  for (const double damping : {0.3, 0.8, 1.0, 1.7})
    expect_response({"actuator_bandwidth", "", {{"time_constant", t}, {"damping", damping}}}, t,
                    2 * damping * t);
  expect_response({"oil_column_resonance", "", {{"time_constant", t}, {"damping", 0.1}}}, t,
                  0.2 * t);
  expect_response({"first_order_lag", "", {{"time_constant", t}}}, 0, t);
}

// y = 1 − e^(−ζωt) (cos ω_d t + ζω/ω_d sin ω_d t) after a step; here a ramp of one time step, which
// is a step half a time step late up to (ω Δt)²/24.
TEST(OilColumnResonance, RingsAtItsFrequency) {
  const double omega = 2 * std::numbers::pi * 5, damping = 0.05;
  Stepper actuator{
      {{"oil_column_resonance", "", {{"time_constant", 1 / omega}, {"damping", damping}}}}, kStep};
  actuator.to(0);
  const double damped = omega * std::sqrt(1 - damping * damping);
  for (int i = 1; i <= 1000; ++i) {
    const double t = kStep * (i - 0.5);
    const double expected =
        1 - std::exp(-damping * omega * t) *
                (std::cos(damped * t) + damping * omega / damped * std::sin(damped * t));
    ASSERT_NEAR(actuator.to(1).displacement[0], expected, std::pow(omega * kStep, 2) / 8);
  }
}

TEST(ActuatorLags, StartAtRestAtTheFirstCommand) {
  for (const auto* kind : {"actuator_bandwidth", "first_order_lag", "oil_column_resonance"}) {
    Stepper actuator{{{kind, "", {{"time_constant", 0.02}}}}, kStep};
    for (int i = 0; i < 10; ++i) EXPECT_EQ(actuator.to(0.3).displacement[0], 0.3) << kind;
  }
}

TEST(RateSaturation, FollowsAtItsVelocityLimitUntilItCatchesUp) {
  Stepper actuator{{{"rate_saturation", "", {{"velocity_limit", 0.5}}}}, kStep};
  actuator.to(0);
  for (int i = 1; i <= 100; ++i) {
    const auto q = actuator.to(0.05);
    EXPECT_NEAR(q.displacement[0], 0.5 * kStep * i, 1e-12);
    if (i == 100) break;  // arrived, possibly except for rounding
    EXPECT_NEAR(q.velocity[0], 0.5, 1e-12);
  }
  EXPECT_EQ(actuator.to(0.05).displacement[0], 0.05);
  EXPECT_EQ(actuator.to(0.0501).displacement[0], 0.0501);
}

TEST(ValveDeadband, IsPlayWithoutALag) {
  Stepper actuator{{{"valve_deadband", "", {{"dead_band", 0.01}}}}, kStep};
  for (const auto& [command, u] : {std::pair{0.0, 0.0},
                                   {0.009, 0.0},
                                   {0.05, 0.04},
                                   {0.035, 0.04},
                                   {-0.05, -0.04},
                                   {0.0, -0.01}})
    EXPECT_NEAR(actuator.to(command).displacement[0], u, 1e-15) << command;
}

// After crossing the band at t_d = d/s, the actuator follows a ramp like a first-order lag:
// u = s (t − t_d) − T s (1 − e^(−(t − t_d)/T)).
TEST(ValveDeadband, LagsBehindTheEdgeOfItsBand) {
  const double band = 0.00105, t = 0.02, speed = 0.1;
  Stepper actuator{{{"valve_deadband", "", {{"dead_band", band}, {"time_constant", t}}}}, kStep};
  for (int i = 0; i <= 300; ++i) {
    const double since = std::max(0.0, kStep * i - band / speed);
    ASSERT_NEAR(actuator.to(speed * kStep * i).displacement[0],
                speed * since - t * speed * (1 - std::exp(-since / t)), 1e-12);
  }
}

// After reversal the error beyond the band, T s, decays to 0 at T ln 2; then the actuator rests.
TEST(ValveDeadband, RestsOnceTheErrorReturnsIntoTheBand) {
  const double band = 0.01, t = 0.0203, speed = 0.1;
  Stepper actuator{{{"valve_deadband", "", {{"dead_band", band}, {"time_constant", t}}}}, kStep};
  for (int i = 0; i <= 1000; ++i) actuator.to(speed * kStep * i);
  double u = 0;
  for (int i = 1; i <= 100; ++i) u = actuator.to(speed * (1 - kStep * i)).displacement[0];

  EXPECT_NEAR(u, speed * (1 - t * std::numbers::ln2) - band, 1e-12);
}

TEST(LoadCompliance, DeflectsInProportionToTheForceAsTheTransducerMeasures) {
  const double k = 1e8, chi = 2e-9;
  Stepper actuator{{spring(k), {"load_compliance", "", {{"compliance", chi}}}}, kStep};
  Quantities<double> q;
  for (int i = 1; i <= 200; ++i) q = actuator.to(0.01);

  EXPECT_NEAR(q.displacement[0], 0.01 / (1 + k * chi), 1e-9);
  EXPECT_NEAR(q.force[0], k * q.displacement[0], 1e-3);
}

}  // namespace
}  // namespace rths::sim
