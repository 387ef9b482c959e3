// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <rths/sim/machine/hydraulics.hpp>

namespace rths::sim::machine {
namespace {

Actuator linear_actuator() {
  Actuator a;
  a.dead_band = 0;
  a.flow_saturation = 1e9;
  a.leakage = 0;
  a.spool_slew = 1e9;
  return a;
}

/// A mass on an actuator, integrated by the midpoint rule.
struct Mass {
  Actuator actuator;
  Supply supply;
  double mass;
  ActuatorState state{};
  double displacement = 0, velocity = 0;

  // The servo asks for a constant velocity.
  void step(double demanded_velocity, double h) {
    const auto at = [&](double x, double v, const ActuatorState& s) {
      const double reference = x + demanded_velocity / actuator.position_gain;
      return rates(actuator, supply, s, {x, v, reference, 0, 0}, supply.pressure).rates;
    };
    const auto moved = [](const ActuatorState& s, const ActuatorState& d, double dt) {
      return ActuatorState{s.pilot + dt * d.pilot, s.spool + dt * d.spool,
                           s.pressure + dt * d.pressure, s.slow_pressure + dt * d.slow_pressure};
    };
    const double force = actuator.piston_area * state.pressure;
    const ActuatorState half = moved(state, at(displacement, velocity, state), h / 2);
    const double x = displacement + h / 2 * velocity;
    const double v = velocity + h / 2 * force / mass;
    state = moved(state, at(x, v, half), h);
    displacement += h * v;
    velocity += h * actuator.piston_area * half.pressure / mass;
  }
};

// Closed form of a damped oscillator after a step, where the spool does not saturate.
TEST(Actuator, HasASecondOrderSpool) {
  const Actuator a = linear_actuator();
  const Supply supply;
  constexpr double kFineStep = 1e-5, kDemand = 0.1;
  const double omega = 2 * M_PI * a.valve_frequency, zeta = a.valve_damping;
  const double damped = omega * std::sqrt(1 - zeta * zeta);
  ActuatorState s;
  for (int i = 1; i <= 10'000; ++i) {
    const ActuatorMotion motion{0, 0, kDemand * a.rated_velocity / a.position_gain, 0, 0};
    const auto moved = [&](const ActuatorState& d, double dt) {
      ActuatorState to = s;
      to.pilot += dt * d.pilot;
      to.spool += dt * d.spool;
      return to;
    };
    const auto first = rates(a, supply, s, motion, supply.pressure).rates;
    s = moved(rates(a, supply, moved(first, kFineStep / 2), motion, supply.pressure).rates,
              kFineStep);
    const double t = i * kFineStep;
    const double expected =
        kDemand * (1 - std::exp(-zeta * omega * t) *
                           (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t)));
    ASSERT_NEAR(s.spool, expected, 1e-5 * kDemand) << t;  // O((ω h)²) = 6e-7
  }
}

// A small constant flow into a closed oil column under a mass: v = v₀ (1 − cos ω t), ω² = k/m.
TEST(Actuator, IsAnOilSpringUnderAMass) {
  Mass m{linear_actuator(), {}, 50e3};
  m.actuator.valve_frequency = 500;
  m.actuator.valve_damping = 1;
  const double omega = std::sqrt(oil_stiffness(m.actuator, m.supply, 0) / m.mass);
  constexpr double kVelocity = 1e-4, kFineStep = 1e-5;
  const double lag = 2 * m.actuator.valve_damping / (2 * M_PI * m.actuator.valve_frequency);
  for (int i = 1; i <= 20'000; ++i) {
    m.step(kVelocity, kFineStep);
    const double t = i * kFineStep - lag;  // the spool is late by 2ζ/ω
    if (t < 20 * lag) continue;
    // The spool's lag rounds off the step: O((ω lag)²). The orifice damps with P/P_s.
    ASSERT_NEAR(m.velocity, kVelocity * (1 - std::cos(omega * t)), 0.01 * kVelocity) << t;
  }
}

TEST(Actuator, HasTheFlowOfAnOrifice) {
  const Actuator a = linear_actuator();
  const Supply supply;
  const double rated = a.piston_area * a.rated_velocity;

  const auto flow = [&](double spool, double pressure) {
    return valve_flow(a, supply, spool, pressure, supply.pressure);
  };
  EXPECT_NEAR(flow(0.5, 0), 0.5 * rated, 1e-12);
  EXPECT_NEAR(flow(0.5, 0.75 * supply.pressure), 0.25 * rated, 1e-12);
  EXPECT_NEAR(flow(-0.5, 0.75 * supply.pressure), -0.5 * std::sqrt(1.75) * rated, 1e-12);
  EXPECT_NEAR(flow(1, 2 * supply.pressure), -rated, 1e-12);  // pushed back
}

TEST(Actuator, LosesFlowToDeadBandSaturationAndDroop) {
  Actuator a = linear_actuator();
  const Supply supply;
  const double rated = a.piston_area * a.rated_velocity;
  a.dead_band = 0.02;
  EXPECT_EQ(valve_flow(a, supply, 0.019, 0, supply.pressure), 0);
  EXPECT_NEAR(valve_flow(a, supply, 0.51, 0, supply.pressure), 0.5 * rated, 1e-12);
  a.dead_band = 0;
  a.flow_saturation = 1;
  EXPECT_NEAR(valve_flow(a, supply, 1, 0, supply.pressure), rated / std::sqrt(2), 1e-12);
  a.flow_saturation = 1e9;
  EXPECT_NEAR(valve_flow(a, supply, 1, 0, 0.64 * supply.pressure), 0.8 * rated, 1e-12);
}

TEST(Actuator, LowersAVerticalPistonByItsLoadAlone) {
  Actuator a = linear_actuator();
  a.single_acting = true;
  const Supply supply;
  const double rated = a.piston_area * a.rated_velocity;

  EXPECT_NEAR(valve_flow(a, supply, -1, 0.25 * supply.pressure, supply.pressure), -0.5 * rated,
              1e-12);
  EXPECT_EQ(valve_flow(a, supply, -1, 0, supply.pressure), 0);
}

TEST(Actuator, LimitsTheRateOfItsSpool) {
  Actuator a = linear_actuator();
  a.spool_slew = 5;
  ActuatorState s;
  s.pilot = 80;

  EXPECT_EQ(rates(a, {}, s, {}, 20e6).rates.spool, 5);
}

TEST(Actuator, ClosesItsPortsBeforeTheStop) {
  const Actuator a = linear_actuator();
  const Supply supply;
  ActuatorState s;
  s.spool = 0.5;
  const auto drawn = [&](double displacement) {
    return rates(a, supply, s, {displacement, 0, displacement, 0, 0}, supply.pressure).drawn;
  };

  EXPECT_NEAR(drawn(a.stroke - a.cushion_length / 2), drawn(0) / 2, 1e-12);
  EXPECT_EQ(drawn(a.stroke), 0);
  EXPECT_EQ(drawn(-a.stroke), drawn(0));  // it may leave the other stop
}

// P Vⁿ is constant, and without a pump the gas grows by the flow drawn.
TEST(Supply, DroopsAsGasExpands) {
  Supply supply;
  supply.pump_flow = 0;
  double gas = supply.gas_volume;
  for (int i = 0; i < 1000; ++i) gas += 1e-3 * supply.gas_rate(supply.pressure_at(gas), 0.7);

  EXPECT_NEAR(gas, supply.gas_volume + 0.7, 1e-12);
  EXPECT_NEAR(supply.pressure_at(gas),
              supply.pressure * std::pow(supply.gas_volume / (supply.gas_volume + 0.7), 1.4), 1e-3);
}

TEST(Supply, IsFilledByItsPump) {
  const Supply supply;
  EXPECT_EQ(supply.gas_rate(supply.pressure - 2 * supply.pump_pressure, 0), -supply.pump_flow);
  EXPECT_EQ(supply.gas_rate(supply.pressure, 0), 0);
}

}  // namespace
}  // namespace rths::sim::machine
