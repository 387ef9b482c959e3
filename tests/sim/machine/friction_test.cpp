// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <rths/sim/machine/friction.hpp>

namespace rths::sim::machine {
namespace {

constexpr double kCoulomb = 5000, kStep = 1e-4;
const LuGre kLaw{1e-5, 1.5, 5e-3, 5e-4};

// Published: F = (F_c + (F_s − F_c) exp(−(v/v_s)²)) sign(v) in steady sliding.
TEST(LuGre, SlidesAtItsSteadyStateLaw) {
  for (const double v : {1e-3, -5e-3, 0.02, -1.0}) {
    double z = 0, force = 0;
    for (int i = 0; i < 20'000; ++i) force = kLaw.advance(z, v, kCoulomb, kStep);
    const double ratio = v / kLaw.stribeck_velocity;
    const double g = kCoulomb * (1 + 0.5 * std::exp(-ratio * ratio));
    EXPECT_NEAR(force, std::copysign(g, v), 1e-9 * g) << v;
  }
}

// Published: for small motions, F = σ₀ u. The next term is relative u/(z of sliding).
TEST(LuGre, IsASpringBeforeItSlides) {
  LuGre law = kLaw;
  law.micro_damping = 0;
  double z = 0;
  constexpr double kVelocity = 1e-6;  // moves 1e-10 m a step, 1e-8 m in all
  double force = 0;
  for (int i = 0; i < 100; ++i) force = law.advance(z, kVelocity, kCoulomb, kStep);

  const double stiffness = kCoulomb / law.presliding;
  EXPECT_NEAR(force, stiffness * 1e-8, stiffness * 1e-8 * 1e-8 / law.presliding);
}

// The step is exact for constant velocity, so its length does not matter.
TEST(LuGre, DoesNotDependOnTheTimeStepAtConstantVelocity) {
  double fine = 0, coarse = 0;
  for (int i = 0; i < 1000; ++i) static_cast<void>(kLaw.advance(fine, 2e-3, kCoulomb, 1e-6));
  static_cast<void>(kLaw.advance(coarse, 2e-3, kCoulomb, 1e-3));

  EXPECT_NEAR(fine, coarse, 1e-14);
}

// A closed cycle never gives energy.
TEST(LuGre, DissipatesInACycle) {
  for (const double amplitude : {1e-6, 1e-5, 1e-3}) {
    double z = 0, work = 0;
    constexpr int kPerCycle = 2000;
    for (int i = 0; i < 3 * kPerCycle; ++i) {
      const double v = amplitude * 2 * M_PI * std::cos(2 * M_PI * i / kPerCycle);
      const double force = kLaw.advance(z, v, kCoulomb, 1.0 / kPerCycle);
      if (i >= 2 * kPerCycle) work += force * v / kPerCycle;
    }
    EXPECT_GT(work, 0) << amplitude;
  }
}

TEST(LuGre, IsFrictionlessWithoutLoad) {
  double z = 1e-6;

  EXPECT_EQ(kLaw.advance(z, 0.1, 0, kStep), 0);
}

}  // namespace
}  // namespace rths::sim::machine
