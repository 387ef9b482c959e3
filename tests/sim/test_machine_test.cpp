// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/sim/test_machine.hpp>

#include "support/files.hpp"
#include "support/lead_rubber.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::sim {
namespace {

using Eigen::Vector2d;
using test::kAxialLoad;
using test::kPeriod;

TestMachine quiet_machine() {
  TestMachine machine = srmd_machine();
  machine.noise = {0, 0, 0};
  machine.specimen = test::plain_lead_rubber();
  return machine;
}

/// Steady-state delay and gain of the long axis for a sine.
struct MachineResponse {
  double delay, gain;
};
MachineResponse response(const TestMachine& machine, double frequency, double amplitude) {
  TestMachineRun run{machine, kPeriod};
  MachineFeedback feedback;
  std::complex<double> in;
  std::complex<double> out;
  const int samples = static_cast<int>(10 / frequency / kPeriod);
  for (int i = 0; i < samples; ++i) {
    const double phase = 2 * std::numbers::pi * frequency * i * kPeriod;
    const Vector2d reference{amplitude * std::sin(phase), 0};
    static_cast<void>(run.step(reference, kAxialLoad, feedback));
    if (i < samples / 2) continue;
    const auto turn = std::exp(std::complex<double>{0, -phase});
    in += reference[0] * turn;
    out += feedback.displacement[0] * turn;
  }
  const auto h = out / in;
  return {-std::arg(h) / (2 * std::numbers::pi * frequency), std::abs(h)};
}

TEST(TestMachine, IsAboutSixtyMillisecondsLateInTheBandOfIsolatedMotion) {
  for (const double frequency : {0.2, 0.35, 0.5, 1.0}) {
    const MachineResponse found = response(quiet_machine(), frequency, 0.12);
    EXPECT_GT(found.delay, 0.050) << frequency;
    EXPECT_LT(found.delay, 0.070) << frequency;
    EXPECT_NEAR(found.gain, 1, 0.03) << frequency;
  }
}

// Friction, dead band and the specimen's hysteresis delay small motions more than large ones. With
// a linear machine, compensation would be perfect and a test of it meaningless.
TEST(TestMachine, IsNotLinear) {
  const double small = response(quiet_machine(), 0.35, 0.01).delay;
  const double large = response(quiet_machine(), 0.35, 0.15).delay;

  EXPECT_GT(small - large, 0.005);
}

TEST(TestMachine, ReportsTheTableForceThatItsEquationOfMotionNeeds) {
  TestMachine machine = quiet_machine();
  TestMachineRun run{machine, kPeriod};
  MachineFeedback feedback;
  const ServoAxis& axis = machine.axes[0];
  constexpr double kCoulomb = 5100, kViscous = 716;  // of the long axis: the paper's Table 2
  Vector2d before = Vector2d::Zero();
  for (int i = 0; i < 3000; ++i) {
    const Vector2d reference{0.1 * std::sin(2 * std::numbers::pi * 0.8 * i * kPeriod), 0};
    static_cast<void>(run.step(reference, kAxialLoad, feedback));
    const double v = (run.true_displacement() - before)[0] / kPeriod;
    before = run.true_displacement();
    if (i < 100 || std::abs(v) < 0.05) continue;  // near reversals the friction changes sign
    const double expected = run.specimen_force()[0] +
                            axis.effective_mass * feedback.acceleration[0] +
                            std::copysign(kCoulomb, v) + kViscous * v + axis.force_offset;
    // Only the velocity is inexact: a difference over 1 ms at up to 10 m/s².
    EXPECT_NEAR(feedback.force[0], expected, kViscous * 10 * kPeriod + 1e-6);
  }
}

TEST(TestMachine, ReachesASlowlyApproachedReference) {
  TestMachineRun run{quiet_machine(), kPeriod};
  MachineFeedback feedback;
  for (int i = 0; i < 20'000; ++i)
    static_cast<void>(run.step({0.1 * std::min(1.0, i / 10'000.0), 0}, kAxialLoad, feedback));

  // Dead band, leakage and pressure feedback leave a static error of a few millimetres.
  EXPECT_NEAR(run.true_displacement()[0], 0.1, 0.006);
}

TEST(TestMachine, ReportsAReferenceBeyondItsStroke) {
  TestMachineRun run{quiet_machine(), kPeriod};
  MachineFeedback feedback;

  EXPECT_EQ(run.step({0, 0.5}, kAxialLoad, feedback), Status::Ok);
  EXPECT_EQ(run.step({0, 0.7}, kAxialLoad, feedback), Status::LimitExceeded);
  EXPECT_EQ(run.step({std::nan(""), 0}, kAxialLoad, feedback), Status::LimitExceeded);
  EXPECT_TRUE(feedback.displacement.allFinite());
}

TEST(TestMachine, RefusesADelayOutOfRange) {
  TestMachine machine = quiet_machine();
  machine.axes[1].transport_delay = 1e9;

  EXPECT_EQ(test::error_of([&] { TestMachineRun(machine, kPeriod); }),
            "test machine: transport_delay is 1000000000, expected 0 to 1");
}

TEST(TestMachine, CannotGoFasterThanItsValvesAllow) {
  TestMachineRun run{quiet_machine(), kPeriod};
  MachineFeedback feedback;
  double fastest = 0;
  double before = 0;
  bool limited = false;
  for (int i = 0; i < 500; ++i) {
    limited = run.step({1.2, 0}, kAxialLoad, feedback) == Status::LimitExceeded || limited;
    fastest = std::max(fastest, (run.true_displacement()[0] - before) / kPeriod);
    before = run.true_displacement()[0];
  }

  const ServoAxis axis = srmd_machine().axes[0];
  // Oil is compressible, so the piston may briefly be slightly faster than the flow.
  EXPECT_LT(fastest, 1.3 * axis.rated_flow / axis.piston_area);
  EXPECT_TRUE(limited);
}

TEST(TestMachine, HasNoSpecimenForceWithAnEmptyTable) {
  TestMachine machine = quiet_machine();
  machine.has_specimen = false;
  TestMachineRun run{machine, kPeriod};
  MachineFeedback feedback;
  for (int i = 0; i < 1000; ++i) static_cast<void>(run.step({0.05, 0.02}, kAxialLoad, feedback));

  EXPECT_EQ(run.specimen_force(), Vector2d::Zero());
  EXPECT_NEAR(run.true_displacement()[0], 0.05, 0.002);
}

TEST(TestMachine, IsBitIdenticalForTheSameSeed) {
  const auto sum_of = [](std::uint64_t seed) {
    TestMachine machine = srmd_machine();
    machine.seed = seed;
    TestMachineRun run{machine, kPeriod};
    MachineFeedback feedback;
    double sum = 0;
    for (int i = 0; i < 500; ++i) {
      static_cast<void>(run.step({0.1 * std::sin(0.01 * i), 0}, kAxialLoad, feedback));
      sum += feedback.force[0] + feedback.displacement[1];
    }
    return sum;
  };

  EXPECT_EQ(sum_of(1), sum_of(1));
  EXPECT_NE(sum_of(1), sum_of(2));
}

TEST(TestMachine, HasTheGivenSensorNoise) {
  TestMachine machine = srmd_machine();
  machine.has_specimen = false;
  TestMachineRun run{machine, kPeriod};
  MachineFeedback feedback;
  double sum = 0;
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    static_cast<void>(run.step(Vector2d::Zero(), kAxialLoad, feedback));
    sum += feedback.displacement[0] * feedback.displacement[0];
  }

  // The deviation of a variance from n samples is √(2/n): 1 % here, so 4 % is four sigma.
  EXPECT_NEAR(std::sqrt(sum / kSamples), machine.noise.displacement,
              0.04 * machine.noise.displacement);
}

TEST(TestMachine, RefusesUnphysicalParameters) {
  TestMachine machine = srmd_machine();
  machine.axes[1].oil_volume = 0;

  EXPECT_EQ(test::error_of([&] { TestMachineRun(machine, kPeriod); }),
            "test machine: oil_volume is 0, expected a positive number");
}

TEST(TestMachine, StepsInRealTime) {
  TestMachineRun run{srmd_machine(), kPeriod};
  MachineFeedback feedback;
  Status status = Status::Ok;
  for (int i = 0; i < 5; ++i)
    EXPECT_REALTIME(status = run.step({0.01 * i, 0.01}, kAxialLoad, feedback));
  EXPECT_EQ(status, Status::Ok);
}

}  // namespace
}  // namespace rths::sim
