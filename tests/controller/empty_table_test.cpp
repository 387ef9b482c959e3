// SPDX-License-Identifier: Apache-2.0
//
// Force correction as in a laboratory: drive the machine with an empty table, identify its own
// force from the sensors' signals, and subtract it from the measured force of another run.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/controller/force_observer.hpp>
#include <rths/sim/test_machine.hpp>

#include "support/period.hpp"

namespace rths {
namespace {

using test::kPeriod;

constexpr int kSamples = 60'000;

struct Measured {
  std::vector<double> displacement, acceleration, force;
};

/// One axis of a machine without a specimen, at high and at low speeds.
Measured empty_table_run(sim::TestMachine machine, int axis, std::uint64_t seed) {
  machine.has_specimen = false;
  machine.seed = seed;
  sim::TestMachineRun run{machine, kPeriod};
  sim::MachineFeedback feedback;
  Measured measured;
  constexpr double kFrequency[] = {0.15, 0.45, 1.1, 1.9};
  constexpr double kAmplitude[] = {0.15, 0.06, 0.025, 0.015};
  for (int i = 0; i < kSamples; ++i) {
    const double t = i * kPeriod;
    Eigen::Vector2d reference = Eigen::Vector2d::Zero();
    for (int k = 0; k < 4; ++k)
      reference[axis] +=
          kAmplitude[k] * std::sin(2 * std::numbers::pi * kFrequency[k] * t) * std::min(1.0, t);
    EXPECT_EQ(run.step(reference, 0, feedback), Status::Ok);
    measured.displacement.push_back(feedback.displacement[axis]);
    measured.acceleration.push_back(feedback.acceleration[axis]);
    measured.force.push_back(feedback.force[axis]);
  }
  return measured;
}

/// The SRMD's axes under both set-ups of the paper's Table 2.
struct Case {
  const char* name;
  int axis;
  controller::MachineForce truth;
  friend std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }
};

sim::TestMachine machine_of(const Case& c) {
  sim::TestMachine machine = sim::srmd_machine();
  auto& axis = machine.axes[static_cast<std::size_t>(c.axis)];
  axis.effective_mass = c.truth.effective_mass;
  const unsigned this_axis = 1U << static_cast<unsigned>(c.axis);
  machine.terms = {
      {"coulomb_friction",
       "",
       {{"friction_force", c.truth.coulomb_friction}, {"presliding", 1e-5}},
       this_axis},
      {"viscous_friction", "", {{"coefficient", c.truth.viscous_friction}}, this_axis}};
  axis.force_offset = c.truth.offset;
  return machine;
}

controller::MachineForce with_offset(controller::MachineForce machine, double offset) {
  machine.offset = offset;
  return machine;
}

class EmptyTable : public ::testing::TestWithParam<Case> {};

TEST_P(EmptyTable, IdentifiesTheMachinesOwnForce) {
  const auto& truth = GetParam().truth;
  const Measured run = empty_table_run(machine_of(GetParam()), GetParam().axis, 42);

  const auto found =
      controller::identify_machine_force(run.displacement, run.acceleration, run.force, kPeriod);

  EXPECT_NEAR(found.machine.effective_mass, truth.effective_mass, 0.005 * truth.effective_mass);
  EXPECT_NEAR(found.machine.coulomb_friction, truth.coulomb_friction,
              0.05 * truth.coulomb_friction);
  EXPECT_NEAR(found.machine.offset, truth.offset, 500);
  EXPECT_NEAR(found.machine.viscous_friction, truth.viscous_friction, found.viscous_friction_95);
  EXPECT_LT(found.residual_rms, 10e3);
  // The residual is only the sensors' noise, 5 kN and 5 mg.
  const sim::SensorNoiseLevels noise;
  const double expected = std::hypot(noise.force, truth.effective_mass * noise.acceleration);
  EXPECT_NEAR(found.residual_rms, expected, 0.03 * expected);
}

TEST_P(EmptyTable, LeavesLessThanTenKilonewtonInAnotherRun) {
  const Measured learnt = empty_table_run(machine_of(GetParam()), GetParam().axis, 42);
  const auto found = controller::identify_machine_force(learnt.displacement, learnt.acceleration,
                                                        learnt.force, kPeriod);
  const Measured run = empty_table_run(machine_of(GetParam()), GetParam().axis, 43);
  controller::ForceObserver observer{found.machine, kPeriod};
  double sum = 0;
  for (std::size_t i = 0; i < run.force.size(); ++i) {
    const double left = observer.step(run.displacement[i], run.acceleration[i], run.force[i]);
    if (i >= 32) sum += left * left;
  }

  EXPECT_LT(std::sqrt(sum / (kSamples - 32)), 10e3);
}

INSTANTIATE_TEST_SUITE_P(
    Table2, EmptyTable,
    ::testing::Values(
        Case{"unison_eqs_long", 0, with_offset(controller::unison_eqs_setup().long_axis, 2e3)},
        Case{"unison_eqs_lat", 1, with_offset(controller::unison_eqs_setup().lat_axis, -1.5e3)},
        Case{"eps_long", 0, with_offset(controller::eps_setup().long_axis, 0.8e3)},
        Case{"eps_lat", 1, controller::eps_setup().lat_axis}),
    [](const auto& c) { return std::string{c.param.name}; });

}  // namespace
}  // namespace rths
