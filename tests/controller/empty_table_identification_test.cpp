// SPDX-License-Identifier: Apache-2.0
//
// Identification from records whose truth is a formula: F = m a + (F_s + μ N) sign(v) + F_d v + d.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/controller/empty_table.hpp>
#include <rths/core/error.hpp>

#include "support/period.hpp"

namespace rths::controller {
namespace {

struct TableTruth {
  double mass = 113'371, coulomb = 5'100, load_coefficient = 0, viscous = 716, offset = 2'000;
  double acceleration_delay = 0;
};

struct TableNoise {
  double displacement = 5e-5, acceleration = 0.049, force = 5e3;
};

/// Motion in closed form: three sines.
struct Sines {
  double x = 0, v = 0, a = 0;
  explicit Sines(double t) {
    constexpr double kFrequency[] = {0.15, 0.8, 2.1}, kAmplitude[] = {0.15, 0.05, 0.02};
    for (int k = 0; k < 3; ++k) {
      const double w = 2 * std::numbers::pi * kFrequency[k];
      x += kAmplitude[k] * std::sin(w * t);
      v += kAmplitude[k] * w * std::cos(w * t);
      a -= kAmplitude[k] * w * w * std::sin(w * t);
    }
  }
};

EmptyTableRecord table_record(const TableTruth& truth, const TableNoise& noise, unsigned seed,
                              double load, double seconds = 30) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal{0, 1};
  EmptyTableRecord record;
  record.period = test::kPeriod;
  for (double t = 0; t < seconds; t += test::kPeriod) {
    const Sines now{t}, late{t - truth.acceleration_delay};
    const double friction = truth.coulomb + truth.load_coefficient * load;
    record.displacement.push_back(now.x + noise.displacement * normal(random));
    record.acceleration.push_back(late.a + noise.acceleration * normal(random));
    record.force.push_back(truth.mass * now.a + friction * (now.v > 0 ? 1 : -1) +
                           truth.viscous * now.v + truth.offset + noise.force * normal(random));
    record.load.push_back(load);
  }
  return record;
}

// Without noise, what remains is the smoothing of the velocity: (2 n h)² ω²/60 of it, 0.4 % at
// 2.1 Hz, of a viscous force of 0.3 kN.
TEST(EmptyTable, IsIdentifiedExactlyWithoutNoise) {
  TableTruth truth;
  truth.acceleration_delay = 0.0043;
  const EmptyTableRecord records[] = {table_record(truth, {0, 0, 0}, 1, 1e6)};

  const auto fit = identify_empty_table(records);

  EXPECT_NEAR(fit.effective_mass.value, truth.mass, 20);
  EXPECT_NEAR(fit.coulomb_friction.value, truth.coulomb, 20);
  EXPECT_NEAR(fit.viscous_friction.value, truth.viscous, 20);
  EXPECT_NEAR(fit.offset.value, truth.offset, 5);
  EXPECT_NEAR(fit.acceleration_delay.value, 0.0043, 1e-5);
  EXPECT_FALSE(fit.load_varies);
  EXPECT_EQ(fit.load_coefficient.value, 0);
}

// Two records under different loads separate F_s from μ N.
TEST(EmptyTable, SeparatesFrictionThatDependsOnTheLoad) {
  TableTruth truth;
  truth.load_coefficient = 0.002;
  const EmptyTableRecord records[] = {table_record(truth, {}, 1, 1e6),
                                      table_record(truth, {}, 2, 1e7)};

  const auto fit = identify_empty_table(records);

  EXPECT_TRUE(fit.load_varies);
  EXPECT_NEAR(fit.load_coefficient.value, 0.002, 3 * fit.load_coefficient.half_width);
  EXPECT_LT(fit.load_coefficient.half_width, 2e-4);
  EXPECT_NEAR(fit.coulomb_friction.value, truth.coulomb, 3 * fit.coulomb_friction.half_width);
  EXPECT_NEAR(fit.machine(1e7).coulomb_friction, 25'100, 500);
}

// 40 seeds at 95 %: fewer than 33 covered have a probability of 0.4 % (binomial).
TEST(EmptyTable, LiesInItsIntervals) {
  TableTruth truth;
  truth.acceleration_delay = 0.002;
  int mass = 0, coulomb = 0, viscous = 0, offset = 0, delay = 0;
  const auto covers = [](const Estimate& e, double value) {
    return std::abs(e.value - value) < e.half_width ? 1 : 0;
  };
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const EmptyTableRecord records[] = {table_record(truth, {}, seed, 1e6, 15)};
    const auto fit = identify_empty_table(records);
    mass += covers(fit.effective_mass, truth.mass);
    coulomb += covers(fit.coulomb_friction, truth.coulomb);
    viscous += covers(fit.viscous_friction, truth.viscous);
    offset += covers(fit.offset, truth.offset);
    delay += covers(fit.acceleration_delay, truth.acceleration_delay);
    EXPECT_LT(fit.effective_mass.half_width, 2000);
    EXPECT_LT(fit.acceleration_delay.half_width, 0.001);
  }
  EXPECT_GE(mass, 33);
  EXPECT_GE(coulomb, 33);
  EXPECT_GE(viscous, 33);
  EXPECT_GE(offset, 33);
  EXPECT_GE(delay, 33);
}

// The noise of the force is white, and that of the accelerometer times the mass is 5.6 kN.
TEST(EmptyTable, LeavesWhiteNoise) {
  const EmptyTableRecord records[] = {table_record({}, {}, 1, 1e6)};

  const auto fit = identify_empty_table(records);

  // The samples near reversals, where friction has no sign, add to the noise of 7.5 kN.
  EXPECT_NEAR(fit.raw_rms, 7.5e3, 0.6e3);
  EXPECT_LT(std::abs(fit.neighbour_correlation), 0.12);
  EXPECT_LE(fit.correlated_share, 0.15);
}

TEST(EmptyTable, ShowsPhysicsThatItOmitsAsACorrelatedResidual) {
  EmptyTableRecord record = table_record({}, {}, 1, 1e6);
  for (std::size_t i = 0; i < record.force.size(); ++i)
    record.force[i] += 2e6 * std::pow(record.displacement[i], 2);
  const EmptyTableRecord records[] = {record};

  const auto fit = identify_empty_table(records);

  EXPECT_GT(fit.neighbour_correlation, 0.5);
  EXPECT_GT(fit.correlated_share, 0.5);
}

TEST(EmptyTable, RefusesRecordsThatDoNotMove) {
  EmptyTableRecord record = table_record({}, {}, 1, 1e6);
  std::fill(record.displacement.begin(), record.displacement.end(), 0.0);
  const EmptyTableRecord still[] = {record};
  EXPECT_THROW((void)identify_empty_table(still), Error);

  record.force.pop_back();
  const EmptyTableRecord unequal[] = {record};
  EXPECT_THROW((void)identify_empty_table(unequal), Error);
  EXPECT_THROW((void)identify_empty_table({}), Error);
  const EmptyTableRecord brief[] = {table_record({}, {}, 1, 1e6, 0.3)};
  EXPECT_THROW((void)identify_empty_table(brief), Error);
}

}  // namespace
}  // namespace rths::controller
