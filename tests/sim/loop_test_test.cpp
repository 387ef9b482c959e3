// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/loop_test.hpp>

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/lead_rubber.hpp"

namespace rths::sim {
namespace {

// z = tanh along a line, so the plug's energy is 4 Q (A − u_y ln 2) up to e^(−2A/u_y), and its
// force at zero displacement is Q.
TEST(LoopTest, ReportsStrengthStiffnessAndEnergyOfACycle) {
  LoopTest test;
  test.time_step = 2e-4;
  const auto history = run_loop_test(rths::test::plain_lead_rubber(), test);

  const auto cycles = cycle_numbers(history, test);

  using rths::test::kPostYieldStiffness, rths::test::kStrength, rths::test::kYieldDisplacement;
  const double A = test.amplitude_long;
  ASSERT_EQ(cycles.size(), 3U);
  for (const auto& cycle : cycles) {
    EXPECT_NEAR(cycle.strength, kStrength, 1e-4 * kStrength);
    EXPECT_NEAR(cycle.peak_force, kStrength + kPostYieldStiffness * A, 1e-4 * cycle.peak_force);
    EXPECT_NEAR(cycle.effective_stiffness, kStrength / A + kPostYieldStiffness,
                1e-4 * cycle.effective_stiffness);
    const double corners = kYieldDisplacement * (1.5 + std::log(2.0));
    EXPECT_NEAR(cycle.energy, 2 * kStrength * (2 * A - corners), 1e-4 * cycle.energy);
  }
}

TEST(LoopTest, BeginsAtRestAndHasTheVelocityOfItsMotion) {
  LoopTest test;
  test.amplitude_lat = 0.1;
  const Bearing dashpot{"dashpot", {{"viscous_friction", "", {{"coefficient", 1.0}}}}, 1};

  const auto h = run_loop_test(dashpot, test);

  EXPECT_EQ(h.displacement_long[0], 0);
  EXPECT_EQ(h.force_long[0], 0);
  for (std::size_t i = 1; i + 1 < h.time.size(); ++i) {
    const double rate =
        (h.displacement_lat[i + 1] - h.displacement_lat[i - 1]) / (2 * test.time_step);
    EXPECT_NEAR(h.force_lat[i], rate, 1e-4);  // a central difference's error is h² u'''/6
  }
}

// A period of 1/0.3 s is not a whole number of steps of 1 ms or 7 ms, yet each cycle must end where
// it began.
TEST(LoopTest, HasAWholeNumberOfStepsPerCycle) {
  LoopTest test;
  test.time_step = 7e-3;
  test.cycles = 40;

  const auto h = run_loop_test(rths::test::plain_lead_rubber(), test);

  EXPECT_NEAR(h.time.back(), test.cycles / test.frequency, 1e-9);
  EXPECT_NEAR(h.displacement_long.back(), 0, 1e-9);
}

TEST(LoopTest, UsesAFewThousandStepsPerCycleAtAnyFrequency) {
  for (const double frequency : {1e-6, 0.1, 0.5, 100.0}) {
    const double steps = 1 / (frequency * time_step_of(frequency));
    EXPECT_GE(steps, 1000 * (1 - 1e-12)) << frequency;
    EXPECT_LE(steps, 20'000 * (1 + 1e-12)) << frequency;
  }
  EXPECT_DOUBLE_EQ(time_step_of(0.5), 1e-3);
}

TEST(LoopTest, RefusesATestWithoutSteps) {
  LoopTest test;
  test.time_step = 1;

  EXPECT_EQ(rths::test::error_of(
                [&] { static_cast<void>(run_loop_test(rths::test::plain_lead_rubber(), test)); }),
            "loop test: expected at least one cycle of at least 20 steps");
}

TEST(Demonstration, ShowsTheEffectOfATerm) {
  const auto shown = demonstrate(term_kind("coulomb_friction"));

  double largest = 0;
  for (std::size_t i = 0; i < shown.with.force_long.size(); ++i)
    largest = std::max(largest, shown.with.force_long[i] - shown.without.force_long[i]);
  EXPECT_NEAR(largest, 1e4, 1);  // the typical friction force
}

}  // namespace
}  // namespace rths::sim
