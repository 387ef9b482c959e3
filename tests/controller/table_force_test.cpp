// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <rths/controller/table_force.hpp>
#include <rths/core/error.hpp>

#include "support/files.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

constexpr double kDuration = 16;  // [s]

TableForce a_machine() {
  return {.effective_mass = 113e3,
          .coulomb_friction = 5.1e3,
          .load_friction = 0.002,
          .viscous_friction = 716,
          .offset = 2e3,
          .presliding = 1.5e-3,
          .accelerometer_delay = 3.3e-3,
          .displacement_lead = 0.6e-3};
}

struct Signals {
  std::vector<double> displacement, acceleration, force, axial_load;
  [[nodiscard]] TableRecording view() const {
    return {displacement, acceleration, force, axial_load};
  }
};

/// The machine's equations along a motion of three frequencies, up to 1.2 g. @param noise  in units
/// of the usual sensors' noise: 50 µm, 5 mg, 5 kN
Signals measured(const TableForce& m, double load_share, double noise, unsigned seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal{0, noise};
  const auto motion = [](double t, int derivative) {
    constexpr double kFrequency[] = {0.3, 1.1, 2.7};
    constexpr double kAmplitude[] = {0.10, 0.05, 0.03};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double w = 2 * std::numbers::pi * kFrequency[i];
      sum += kAmplitude[i] * std::pow(w, derivative) *
             std::sin(w * t + i + derivative * std::numbers::pi / 2);
    }
    return sum;
  };
  Signals run;
  double z = 0;
  constexpr int kSubsteps = 10;
  for (double t = 0; t < kDuration; t += kPeriod) {
    for (int k = 0; k < kSubsteps; ++k) {  // dz/dx = (1 − z sign v)/δ, exact at constant direction
      const double v = motion(t - kPeriod + (k + 0.5) * kPeriod / kSubsteps, 1);
      const double level = v < 0 ? -1 : 1;
      z = level + (z - level) * std::exp(-std::abs(v) * kPeriod / kSubsteps / m.presliding);
    }
    const double load = 10e6 * (1 + load_share * std::sin(2.3 * t));
    run.displacement.push_back(motion(t + m.displacement_lead, 0) + 5e-5 * normal(random));
    run.acceleration.push_back(motion(t - m.accelerometer_delay, 2) + 0.049 * normal(random));
    run.force.push_back(m.effective_mass * motion(t, 2) +
                        (m.coulomb_friction + m.load_friction * load) * z +
                        m.viscous_friction * motion(t, 1) + m.offset + 5e3 * normal(random));
    run.axial_load.push_back(load);
  }
  return run;
}

TableIdentification identified(const Signals& run) {
  const TableRecording runs[] = {run.view()};
  return identify_table_force(runs, {});
}

TEST(TableIdentification, FindsEveryParameterWithoutNoise) {
  const TableForce truth = a_machine();

  const TableForce found = identified(measured(truth, 0.5, 0, 1)).machine;

  // Interpolation and the sums over a sample leave errors of second order in the period.
  EXPECT_NEAR(found.effective_mass, truth.effective_mass, 1e-4 * truth.effective_mass);
  EXPECT_NEAR(found.coulomb_friction, truth.coulomb_friction, 0.02 * truth.coulomb_friction);
  EXPECT_NEAR(found.load_friction, truth.load_friction, 0.01 * truth.load_friction);
  EXPECT_NEAR(found.viscous_friction, truth.viscous_friction, 0.05 * truth.viscous_friction);
  EXPECT_NEAR(found.offset, truth.offset, 20);
  EXPECT_NEAR(found.presliding, truth.presliding, 0.03 * truth.presliding);
  EXPECT_NEAR(found.accelerometer_delay, truth.accelerometer_delay, 2e-5);
  EXPECT_NEAR(found.displacement_lead, truth.displacement_lead, 5e-5);
}

// 40 seeds at 95 %: fewer than 33 covered have a probability of 0.07 % (binomial). Sanitizers,
// which make a seed take seconds, have 10: fewer than 7 have 0.1 %.
TEST(TableIdentification, FindsEveryParameterInItsInterval) {
  const TableForce truth = a_machine();
  const unsigned seeds = test::RealTimeGuard::supported() ? 40 : 10;
  const int fewest = seeds == 40 ? 33 : 7;
  constexpr double TableForce::*kValues[] = {
      &TableForce::effective_mass,      &TableForce::coulomb_friction, &TableForce::load_friction,
      &TableForce::viscous_friction,    &TableForce::offset,           &TableForce::presliding,
      &TableForce::accelerometer_delay, &TableForce::displacement_lead};
  std::array<int, std::size(kValues)> covered{};
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const auto found = identified(measured(truth, 0.5, 1, seed));
    for (std::size_t i = 0; i < covered.size(); ++i)
      if (std::abs(found.machine.*kValues[i] - truth.*kValues[i]) <= found.half_width.*kValues[i])
        ++covered[i];
    // The accelerometer's noise times the mass is 5.5 kN; that of the force is 5 kN, of which cubic
    // interpolation between samples leaves 4.0 to 5 kN.
    EXPECT_GT(found.sample_rms, 0.98 * std::hypot(5.5e3, 4.0e3));
    EXPECT_LT(found.sample_rms, 1.02 * std::hypot(5.5e3, 5.0e3));
    EXPECT_LT(found.half_width.effective_mass, 200);
    EXPECT_LT(found.half_width.viscous_friction, 1'000);
  }
  for (std::size_t i = 0; i < covered.size(); ++i)
    EXPECT_GE(covered[i], fewest) << "parameter " << i;
}

// At rest friction has any value between its limits, which would bias the others.
TEST(TableIdentification, LeavesOutRest) {
  const TableForce truth = a_machine();
  Signals run = measured(truth, 0.5, 1, 1);
  std::mt19937_64 random{2};
  std::normal_distribution<double> normal{0, 1};
  const double at = run.displacement.back();
  for (int i = 0; i < 16'000; ++i) {  // all of the friction, in one direction
    run.displacement.push_back(at + 5e-5 * normal(random));
    run.acceleration.push_back(0.049 * normal(random));
    run.force.push_back(truth.offset + 25e3 + 5e3 * normal(random));
    run.axial_load.push_back(10e6);
  }

  const auto found = identified(run);

  EXPECT_NEAR(found.machine.offset, truth.offset, 2 * found.half_width.offset);
  EXPECT_LT(found.half_width.offset, 300);
  EXPECT_NEAR(found.machine.viscous_friction, truth.viscous_friction,
              2 * found.half_width.viscous_friction);
}

// The interval reaches the truth although the estimate is cut off at zero.
TEST(TableIdentification, StatesHowLargeAFrictionOfZeroMayBe) {
  TableForce truth = a_machine();
  truth.viscous_friction = 0;
  int at_zero = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto found = identified(measured(truth, 0.5, 1, seed));
    EXPECT_GT(found.half_width.viscous_friction, 0);
    at_zero += found.machine.viscous_friction == 0 ? 1 : 0;
  }
  EXPECT_GT(at_zero, 0);  // of 6; none has a probability of 2 %
}

TEST(TableIdentification, ShowsPhysicsThatItOmitsAsACorrelatedResidual) {
  Signals run = measured(a_machine(), 0.5, 1, 1);
  EXPECT_LE(identified(run).correlated_share, 0.2);
  for (std::size_t i = 0; i < run.force.size(); ++i)
    run.force[i] += 2e6 * std::pow(run.displacement[i], 2);

  const auto found = identified(run);

  EXPECT_GT(found.neighbour_correlation, 0.5);
  EXPECT_GT(found.correlated_share, 0.5);
}

TEST(TableIdentification, CannotTellTheLoadsFrictionFromAConstantLoad) {
  const auto found = identified(measured(a_machine(), 0, 0, 1));

  EXPECT_FALSE(found.has_load_friction);
  EXPECT_EQ(found.machine.load_friction, 0);
  // All friction: 5.1 kN + 0.002 × 10 MN.
  EXPECT_NEAR(found.machine.coulomb_friction, 25.1e3, 0.02 * 25.1e3);
}

TEST(TableIdentification, WorksWithoutAMeasuredLoad) {
  Signals run = measured(a_machine(), 0, 0, 1);
  run.axial_load.clear();

  EXPECT_NEAR(identified(run).machine.effective_mass, 113e3, 20);
}

TEST(TableIdentification, RefusesSignalsThatItCannotUse) {
  const Signals good = measured(a_machine(), 0.5, 0, 1);
  Signals lengths = good;
  lengths.force.pop_back();
  Signals infinite = good;
  infinite.acceleration[700] = std::numeric_limits<double>::quiet_NaN();
  Signals rest = good;
  for (auto* signal : {&rest.displacement, &rest.acceleration}) signal->assign(signal->size(), 0.0);
  Signals reversed = good;
  for (double& force : reversed.force) force = -force;

  EXPECT_NE(test::error_of([&] { identified(lengths); }).find("run 1: the measured signals differ"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] { identified(infinite); }).find("not a finite number"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] { identified(rest); }).find("do not excite"), std::string::npos);
  EXPECT_NE(test::error_of([&] { identified(reversed); }).find("wrong sign"), std::string::npos);
  EXPECT_NE(test::error_of([&] {
              (void)identify_table_force(std::span<const TableRecording>{}, {});
            }).find("no run"),
            std::string::npos);
}

TEST(TableForceObserver, LeavesNothingOfAnEmptyTable) {
  const TableForce machine = a_machine();
  const Signals run = measured(machine, 0.5, 0, 1);
  TableForceObserver observer{machine, {}};
  double largest = 0;

  for (std::size_t i = 0; i < run.force.size(); ++i) {
    const double left =
        observer.step({run.displacement[i], run.acceleration[i], run.force[i], run.axial_load[i]});
    if (i > 2000) largest = std::max(largest, std::abs(left));
  }

  // The machine's force reaches 1.4 MN. Friction at a reversal passes from −25 to +25 kN within
  // few samples; half a sample of time there is the largest error.
  EXPECT_LT(largest, 2e3);
}

TEST(TableForceObserver, ReportsTheAgeOfItsResult) {
  TableForce machine;
  machine.accelerometer_delay = 4e-3;
  TableForceObserver observer{machine, {.cutoff = 50}};

  // A ramp of the force leaves the observer late by its lag.
  double out = 0;
  for (int i = 0; i < 2000; ++i) out = observer.step({0, 0, 1e6 * i * kPeriod, 0});

  EXPECT_NEAR(observer.lag(), 4e-3 + std::numbers::sqrt2 / (2 * std::numbers::pi * 50), 1e-12);
  EXPECT_NEAR((1e6 * 1.999 - out) / 1e6, observer.lag(), 1e-4);
}

TEST(TableForceObserver, AlignsTheDisplacementWithTheForce) {
  TableForce machine;
  machine.accelerometer_delay = 1.3e-3;
  machine.displacement_lead = 0.4e-3;
  TableForceObserver observer{machine, {}};

  double force = 0;
  for (int i = 0; i < 2000; ++i)
    force = observer.step({0.2 * i * kPeriod, 0, 1e6 * i * kPeriod, 0});

  EXPECT_NEAR(observer.displacement(), 0.2 * (1.999 - 1.7e-3), 1e-9);
  EXPECT_NEAR(force, 1e6 * (1.999 - 1.3e-3), 1e-3);
}

TEST(TableForceObserver, HoldsTheLastGoodSample) {
  TableForceObserver observer{a_machine(), {}};
  for (int i = 0; i < 100; ++i) (void)observer.step({0, 0, 50e3, 0});
  const double before = observer.step({0, 0, 50e3, 0});

  const double bad = observer.step({0, std::numeric_limits<double>::infinity(), 50e3, 0});

  EXPECT_NEAR(bad, before, 1);
  EXPECT_EQ(observer.bad_samples(), 1);
}

TEST(TableForceObserver, RefusesValuesOutOfRange) {
  TableForce machine;
  machine.accelerometer_delay = 0.1;
  EXPECT_THROW((TableForceObserver{machine, {}}), Error);
  machine = {.presliding = 0};
  EXPECT_THROW((TableForceObserver{machine, {}}), Error);
  EXPECT_THROW((TableForceObserver{{}, {.period = 0}}), Error);
}

TEST(TableForceObserver, WorksInRealTime) {
  TableForceObserver observer{a_machine(), {.cutoff = 60}};

  EXPECT_REALTIME((void)observer.step({0.01, 0.2, 3e4, 1e7}));
}

}  // namespace
}  // namespace rths::controller
