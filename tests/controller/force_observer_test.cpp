// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/controller/force_observer.hpp>
#include <rths/core/constants.hpp>

#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

constexpr double kForceNoise = 5e3;                             // [N]
constexpr double kAccelerationNoise = 5e-3 * kStandardGravity;  // 5 mg
constexpr double kDisplacementNoise = 5e-5;                     // [m]

/// Simulated sensor signals of a machine with an empty table: motion of several frequencies, at
/// high and at low speeds.
struct EmptyTableRun {
  std::vector<double> displacement, acceleration, force, true_force;

  EmptyTableRun(const MachineForce& machine, double noise, unsigned seed) {
    std::mt19937_64 random{seed};
    std::normal_distribution<double> normal{0, 1};
    for (int i = 0; i < 60'000; ++i) {
      const double t = i * kPeriod;
      double x = 0;
      double v = 0;
      double a = 0;
      constexpr double kFrequency[] = {0.15, 0.45, 1.1, 1.9};
      constexpr double kAmplitude[] = {0.30, 0.10, 0.06, 0.03};
      for (int k = 0; k < 4; ++k) {
        const double w = 2 * std::numbers::pi * kFrequency[k];
        x += kAmplitude[k] * std::sin(w * t + k);
        v += kAmplitude[k] * w * std::cos(w * t + k);
        a -= kAmplitude[k] * w * w * std::sin(w * t + k);
      }
      displacement.push_back(x + noise * kDisplacementNoise * normal(random));
      acceleration.push_back(a + noise * kAccelerationNoise * normal(random));
      true_force.push_back(machine(v, a));
      force.push_back(true_force.back() + noise * kForceNoise * normal(random));
    }
  }
};

struct Setup {
  const char* name;
  MachineForce machine;
  friend std::ostream& operator<<(std::ostream& out, const Setup& s) { return out << s.name; }
};

MachineForce with_offset(MachineForce machine, double offset) {
  machine.offset = offset;
  return machine;
}

class PaperSetup : public ::testing::TestWithParam<Setup> {};

TEST_P(PaperSetup, IsIdentifiedFromANoisyEmptyTableRun) {
  const MachineForce& truth = GetParam().machine;
  const EmptyTableRun run{truth, 1, 42};

  const auto found = identify_machine_force(run.displacement, run.acceleration, run.force, kPeriod);

  EXPECT_NEAR(found.machine.effective_mass, truth.effective_mass, 0.005 * truth.effective_mass);
  EXPECT_NEAR(found.machine.coulomb_friction, truth.coulomb_friction,
              0.05 * truth.coulomb_friction);
  EXPECT_NEAR(found.machine.offset, truth.offset, 500);
  EXPECT_NEAR(found.machine.viscous_friction, truth.viscous_friction, found.viscous_friction_95);
  EXPECT_LT(found.residual_rms, 10e3);
  // The residual is only the added noise.
  const double noise = std::hypot(kForceNoise, truth.effective_mass * kAccelerationNoise);
  EXPECT_NEAR(found.residual_rms, noise, 0.02 * noise);
}

TEST_P(PaperSetup, LeavesLessThanTenKilonewtonWhenTheObserverUsesIt) {
  const EmptyTableRun learnt_from{GetParam().machine, 1, 42};
  const auto found = identify_machine_force(learnt_from.displacement, learnt_from.acceleration,
                                            learnt_from.force, kPeriod);
  const EmptyTableRun run{GetParam().machine, 1, 43};  // a noise seed not used in the fit
  ForceObserver observer{found.machine, kPeriod};
  double sum = 0;

  for (std::size_t i = 0; i < run.force.size(); ++i) {
    const double left = observer.step(run.displacement[i], run.acceleration[i], run.force[i]);
    if (i >= 32) sum += left * left;
  }

  EXPECT_LT(std::sqrt(sum / static_cast<double>(run.force.size() - 32)), 10e3);
}

INSTANTIATE_TEST_SUITE_P(
    Table2, PaperSetup,
    ::testing::Values(Setup{"unison_eqs_long", with_offset(unison_eqs_setup().long_axis, 2e3)},
                      Setup{"unison_eqs_lat", with_offset(unison_eqs_setup().lat_axis, -1.5e3)},
                      Setup{"eps_long", with_offset(eps_setup().long_axis, 0.8e3)},
                      Setup{"eps_lat", with_offset(eps_setup().lat_axis, 0)}),
    [](const auto& setup) { return std::string{setup.param.name}; });

// Over many seeds a 95 % interval misses the truth in about one run of twenty.
TEST(ForceIdentification, HasIntervalsThatCoverTheTruth) {
  const MachineForce truth = with_offset(unison_eqs_setup().long_axis, 2e3);
  int covered = 0;
  const int seeds = test::is_long() ? 40 : 12;
  for (int seed = 0; seed < seeds; ++seed) {
    const EmptyTableRun run{truth, 1, 100 + static_cast<unsigned>(seed)};
    const auto found =
        identify_machine_force(run.displacement, run.acceleration, run.force, kPeriod);
    covered += std::abs(found.machine.viscous_friction - truth.viscous_friction) <=
                       found.viscous_friction_95
                   ? 1
                   : 0;
  }
  // The chance of more misses at 5 % each is below 1 %.
  EXPECT_GE(covered, seeds - (test::is_long() ? 6 : 3));
}

TEST(ForceIdentification, KeepsFrictionFromGoingNegative) {
  MachineForce frictionless;
  frictionless.effective_mass = 1e5;
  const EmptyTableRun run{frictionless, 1, 7};

  const auto found = identify_machine_force(run.displacement, run.acceleration, run.force, kPeriod);

  EXPECT_GE(found.machine.coulomb_friction, 0);
  EXPECT_GE(found.machine.viscous_friction, 0);
  EXPECT_NEAR(found.machine.effective_mass, 1e5, 500);
}

TEST(ForceIdentification, RefusesARunWithoutMotion) {
  const std::vector<double> still(2000, 0.0);

  EXPECT_EQ(test::error_of(
                [&] { static_cast<void>(identify_machine_force(still, still, still, kPeriod)); }),
            "force identification: the run does not excite inertia and friction");
}

TEST(MachineForce, HasNoFrictionBelowTheRestVelocity) {
  const MachineForce machine = unison_eqs_setup().long_axis;

  EXPECT_EQ(machine(0.00126, 0), 0);
  EXPECT_NEAR(machine(0.00128, 0), 5'100 + 716 * 0.00128, 1e-9);
  EXPECT_NEAR(machine(-0.00128, 0), -5'100 - 716 * 0.00128, 1e-9);
}

TEST(MachineForce, HasTheMassesThatThePaperPrintsAsWeights) {
  const double weight = unison_eqs_setup().long_axis.effective_mass * kStandardGravity;

  EXPECT_NEAR(weight, 1'111.79e3, 1);
  EXPECT_NEAR(eps_setup().lat_axis.effective_mass * kStandardGravity, 1'001.38e3, 1);
}

TEST(MachineForce, RaisesSpeedToItsExponent) {
  MachineForce machine;
  machine.viscous_friction = 100;
  machine.exponent = 0.5;

  EXPECT_NEAR(machine(-0.25, 0), -50, 1e-12);
}

TEST(ForceObserver, WorksInRealTime) {
  ForceObserver observer{eps_setup().long_axis, kPeriod};
  double force = 0;
  for (int i = 0; i < 50; ++i) EXPECT_REALTIME(force = observer.step(0.001 * i, 0.1, 1e5));
  EXPECT_TRUE(std::isfinite(force));
}

TEST(MachineForce, WorksInRealTime) {
  const MachineForce machine = eps_setup().long_axis;
  double force = 0;
  EXPECT_REALTIME(force = machine(0.5, 1));
  EXPECT_GT(force, 0);
}

}  // namespace
}  // namespace rths::controller
