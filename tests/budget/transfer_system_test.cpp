// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/budget/transfer_system.hpp>
#include <rths/core/error.hpp>

#include "support/lead_rubber.hpp"

namespace rths::budget {
namespace {

using sim::AxisTransfer;
using sim::TransferRecord;

constexpr double kPeriod = 0.001;

// Sines up to 5 Hz of rising and falling amplitude, about 100 mm.
double reference_at(double t) {
  const double pi2 = 2 * std::numbers::pi;
  return 0.05 * std::sin(pi2 * 0.05 * t) *
         (std::sin(pi2 * 0.4 * t) + 0.6 * std::sin(pi2 * 1.1 * t + 1) +
          0.15 * std::sin(pi2 * 2.7 * t + 2) + 0.03 * std::sin(pi2 * 5.1 * t));
}

/// One axis of the machine of the examples, with a bearing on it.
TransferRecord recorded(const sim::TestMachine& machine, double seconds) {
  sim::TestMachineRun run{machine, kPeriod};
  sim::MachineFeedback feedback;
  TransferRecord record;
  record.period = kPeriod;
  for (int n = 1; n <= static_cast<int>(seconds / kPeriod); ++n) {
    const double reference = reference_at(n * kPeriod);
    static_cast<void>(run.step({reference, 0}, machine.specimen.axial_load, feedback));
    record.reference.push_back(reference);
    record.displacement.push_back(feedback.displacement[0]);
    record.force.push_back(feedback.force[0]);
  }
  return record;
}

sim::TestMachine laboratory() {
  sim::TestMachine machine = sim::srmd_machine();
  machine.specimen = test::plain_lead_rubber();
  return machine;
}

TEST(AxisTransfer, RecoversTheHydraulicsOfAMachine) {
  const sim::TestMachine machine = laboratory();
  const AxisTransfer found = identify_transfer(recorded(machine, 40));
  const sim::ServoAxis& axis = machine.axes[0];
  const double fastest = axis.rated_flow / axis.piston_area;
  const double force = axis.piston_area * axis.supply_pressure;
  EXPECT_NEAR(found.gain, axis.position_gain, 0.05 * axis.position_gain);
  EXPECT_NEAR(found.valve_frequency, axis.valve_frequency, 0.1 * axis.valve_frequency);
  EXPECT_NEAR(found.dead_band, axis.dead_band * fastest / axis.position_gain, 5e-5);
  const double compliance =
      axis.oil_volume / (4 * axis.bulk_modulus * std::pow(axis.piston_area, 2));
  EXPECT_NEAR(found.compliance, compliance, 0.1 * compliance);
  EXPECT_NEAR(found.pressure_feedback, axis.pressure_gain * fastest / force,
              0.2 * axis.pressure_gain * fastest / force);
  EXPECT_LT(found.pressure_washout, 0.02);
  EXPECT_NEAR(found.delay(), 1 / axis.position_gain + axis.transport_delay, 0.001);
  // The noise of the displacement sensor is 50 µm.
  EXPECT_LT(found.residual, 1.1 * machine.noise.displacement);
  EXPECT_LT(found.error, 0.02 * found.error_without);
  EXPECT_EQ(found.confidence, 1);
}

// Many valves feed back the pressure of vibration only.
TEST(AxisTransfer, FindsTheWashoutOfThePressureFeedback) {
  sim::TestMachine machine = laboratory();
  machine.axes[0].pressure_washout = 1;
  const AxisTransfer found = identify_transfer(recorded(machine, 40));
  const sim::ServoAxis& axis = machine.axes[0];
  EXPECT_NEAR(found.gain, axis.position_gain, 0.02 * axis.position_gain);
  EXPECT_NEAR(found.valve_frequency, axis.valve_frequency, 0.05 * axis.valve_frequency);
  EXPECT_NEAR(found.pressure_washout, axis.pressure_washout, 0.2);
  EXPECT_LT(found.residual, 1.1 * machine.noise.displacement);
}

// x' = K (r − x): closed form of a first-order lag.
// Half as wide again, for the noise of one draw.
TEST(AxisTransfer, GivesIntervalsThatHoldTheMachine) {
  const sim::TestMachine machine = laboratory();
  const AxisTransfer found = identify_transfer(recorded(machine, 40));
  const sim::ServoAxis& axis = machine.axes[0];
  const auto expect = [&](const char* name, double truth) {
    for (const auto& p : found.parameters) {
      if (p.name != name) continue;
      EXPECT_NEAR(p.value, truth, 1.5 * p.half_width) << name;
      EXPECT_LT(p.half_width, 0.2 * truth) << name;
    }
  };
  expect("gain", axis.position_gain);
  expect("valve_frequency", axis.valve_frequency);
  expect("valve_damping", axis.valve_damping);
  expect("supply_force", axis.piston_area * axis.supply_pressure);
}

TEST(AxisTransfer, FindsTheLagOfALinearSystem) {
  TransferRecord record;
  record.period = kPeriod;
  const double K = 12;
  double x = 0;
  for (int n = 1; n <= 20'000; ++n) {
    const double r = reference_at(n * kPeriod);
    x = r + (x - r) * std::exp(-K * kPeriod);
    record.reference.push_back(r);
    record.displacement.push_back(x);
    record.force.push_back(0);
  }
  const AxisTransfer found = identify_transfer(record);
  EXPECT_NEAR(found.delay(), 1 / K, 0.001);
  EXPECT_LT(found.dead_band, 1e-5);
  EXPECT_LT(found.error, 1e-3);
}

TEST(AxisTransfer, MovesAServoAxisAlike) {
  sim::TestMachine machine = laboratory();
  machine.noise = {0, 0, 0};
  const auto record = recorded(machine, 20);
  const AxisTransfer found = identify_transfer(record);
  machine.axes[0] = servo_axis(found, machine.axes[0]);
  const auto again = recorded(machine, 20);
  double apart = 0, all = 0;
  for (std::size_t i = 0; i < record.displacement.size(); ++i) {
    apart += std::pow(again.displacement[i] - record.displacement[i], 2);
    all += std::pow(record.displacement[i], 2);
  }
  EXPECT_LT(std::sqrt(apart / all), 2e-3);
}

TEST(AxisTransfer, RefusesARecordThatIsTooShort) {
  EXPECT_THROW(static_cast<void>(identify_transfer(recorded(laboratory(), 5))), Error);
}

}  // namespace
}  // namespace rths::budget
