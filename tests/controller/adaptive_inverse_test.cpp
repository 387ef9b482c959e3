// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include <rths/controller/adaptive_inverse.hpp>
#include <rths/controller/path_sampler.hpp>
#include <rths/core/error.hpp>

#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

/// A linear machine: a₃x⃛ + a₂ẍ + a₁ẋ + x = r, integrated in steps of 0.01 ms.
struct LinearMachine {
  double a1 = 0.060, a2 = 1.5e-3, a3 = 1.9e-5;
  double x = 0, v = 0, a = 0;
  double operator()(double reference) {
    constexpr int kSteps = 100;
    const double h = kPeriod / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      a += h * (reference - x - a1 * v - a2 * a) / a3;
      v += h * a;
      x += h * v;
    }
    return x;
  }
};

double learnt_target(double t) {
  constexpr double kFrequency[] = {0.4, 0.9, 1.7, 2.6};
  constexpr double kAmplitude[] = {0.10, 0.05, 0.02, 0.01};
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    sum += kAmplitude[i] * std::sin(2 * std::numbers::pi * kFrequency[i] * t + i);
  return sum * std::min(1.0, t / 2);
}

/// A linear machine has neither load nor dead band.
AdaptiveInverseSettings linear_settings() {
  AdaptiveInverseSettings settings;
  settings.initial.load = settings.initial.load_rate = 0;
  settings.initial.dead_band = settings.initial.flow_loss = 0;
  settings.a4 = 0;
  settings.uncertainty = {0.01, 0.01, 3e-4, 3e-6, 0, 0, 0, 0};
  return settings;
}

struct Loop {
  AdaptiveInverse inverse;
  LinearMachine machine;
  double measured = 0, worst = 0;
  int tick = 0;

  /// Runs for a time. @param noise  of the measured displacement [m]
  void run(double duration, double noise = 0, double scale = 1) {
    std::mt19937_64 random{7};
    std::normal_distribution<double> normal{0, 1};
    worst = 0;
    for (const int end = tick + static_cast<int>(duration / kPeriod); tick < end; ++tick) {
      const double target = scale * learnt_target(tick * kPeriod);
      worst = std::max(worst, std::abs(machine.x - target));
      const double reference = inverse.step(target, machine.x + noise * normal(random), 0, 1, true);
      machine(reference);
    }
  }
};

TEST(AdaptiveInverse, LearnsALinearMachine) {
  Loop loop{AdaptiveInverse{linear_settings()}, {}};

  loop.run(4);
  const double before = loop.worst;
  loop.run(36);
  loop.run(4);

  const InverseCoefficients found = loop.inverse.coefficients();
  // The reference acts in the period after its computation, which the lead includes: half of it
  // for the hold, the other half for the tick at which the result is seen.
  EXPECT_NEAR(found.a0, 1, 1e-3);
  EXPECT_NEAR(found.a1, 0.060 + kPeriod, 1e-3);
  EXPECT_NEAR(found.a2, 1.5e-3, 2e-4);
  EXPECT_GT(before, 2e-3);
  EXPECT_LT(loop.worst, 0.15 * before);
}

// ATS regresses the command on the measured displacement, whose noise biases it.
TEST(AdaptiveInverse, IsNotBiasedBySensorNoise) {
  Loop clean{AdaptiveInverse{linear_settings()}, {}};
  Loop noisy{AdaptiveInverse{linear_settings()}, {}};

  clean.run(30);
  noisy.run(30, 1e-3);  // 1 mm, twenty times that of the machine

  const InverseCoefficients a = clean.inverse.coefficients();
  const InverseCoefficients b = noisy.inverse.coefficients();
  // 10,000 effective samples of 1 mm on 80 mm RMS, and on 0.35 m/s for a1.
  EXPECT_NEAR(a.a0, b.a0, 4e-4);
  EXPECT_NEAR(a.a1, b.a1, 2e-4);
}

TEST(AdaptiveInverse, KeepsItsCoefficientsAtRest) {
  Loop loop{AdaptiveInverse{linear_settings()}, {}};
  loop.run(20);
  loop.run(8, 5e-5, 0);  // the speed's memory fades in a few seconds
  const double a1 = loop.inverse.coefficients().a1;

  loop.run(60, 5e-5, 0);

  EXPECT_FALSE(loop.inverse.learning());
  EXPECT_NEAR(loop.inverse.coefficients().a1, a1, 1e-6);  // the fade of 0.3 s ends
}

TEST(AdaptiveInverse, StopsLearningWhileClipped) {
  AdaptiveInverseSettings settings = linear_settings();
  settings.largest_reference = 0.02;
  Loop loop{AdaptiveInverse{settings}, {}};
  double largest = 0;
  bool learnt_while_clipped = false;
  for (int i = 0; i < 20'000; ++i) {
    const long clipped = loop.inverse.clipped();
    const double reference =
        loop.inverse.step(learnt_target(i * kPeriod), loop.machine.x, 0, 1, true);
    largest = std::max(largest, std::abs(reference));
    learnt_while_clipped |= loop.inverse.clipped() > clipped && loop.inverse.learning();
    loop.machine(reference);
  }

  EXPECT_EQ(largest, 0.02);
  EXPECT_GT(loop.inverse.clipped(), 1000);
  EXPECT_FALSE(learnt_while_clipped);
  EXPECT_NEAR(loop.inverse.coefficients().a0, 1, 0.04);  // within four standard deviations
}

TEST(AdaptiveInverse, DoesNotLearnFromBadFeedback) {
  Loop loop{AdaptiveInverse{linear_settings()}, {}};
  loop.run(20);
  const double a1 = loop.inverse.coefficients().a1;

  for (int i = 0; i < 1000; ++i) {
    const double reference = loop.inverse.step(
        learnt_target(20 + i * kPeriod), std::numeric_limits<double>::quiet_NaN(), 0, 1, true);
    ASSERT_TRUE(std::isfinite(reference));
    EXPECT_FALSE(loop.inverse.learning());
  }

  EXPECT_EQ(loop.inverse.bad_samples(), 1000);
  EXPECT_NEAR(loop.inverse.coefficients().a1, a1, 1e-4);
}

TEST(AdaptiveInverse, DoesNotLearnFromAStuckOrReversedSensor) {
  for (const double factor : {0.0, -1.0}) {
    AdaptiveInverse inverse{linear_settings()};
    LinearMachine machine;
    for (int i = 0; i < 20'000; ++i)
      machine(inverse.step(learnt_target(i * kPeriod), factor * machine.x, 0, 1, true));

    // Four standard deviations bound a fit from the moments in which the error is small.
    EXPECT_NEAR(inverse.coefficients().a0, 1, 0.0401);
    EXPECT_NEAR(inverse.coefficients().a1, 0.0508, 0.0401);
    EXPECT_LT(std::abs(machine.x), 0.5);
  }
}

TEST(AdaptiveInverse, SendsTheBareTargetWithoutLead) {
  AdaptiveInverse inverse{linear_settings()};

  EXPECT_EQ(inverse.step(0.123, 0.1, 1e6, 0, true), 0.123);
}

TEST(AdaptiveInverse, BoundsTheShareOfTheForce) {
  AdaptiveInverseSettings settings;
  AdaptiveInverse inverse{settings};
  for (int i = 0; i < 100; ++i) (void)inverse.step(0, 0, 0, 1, true);

  // A jump of the force sensor to twice the capacity: its rate alone would lead by a metre.
  const double reference = inverse.step(0, 0, 2 * settings.force_capacity, 1, true);

  EXPECT_LE(std::abs(reference), settings.largest_load_lead + settings.initial.dead_band + 1e-12);
  EXPECT_FALSE(inverse.learning());
}

/// A motion along a path, and the time of the path in each tick [periods].
double motion_at(double path) { return 0.1 * std::sin(3 * path * kPeriod); }

// A late target: the pace falls to a tenth and rises again, and never is a whole one in between.
double pace_at(int tick) {
  const double since = tick - 1'000;
  return since < 0 || since >= 20 ? 1 : 0.1 + 0.08 * std::abs(since - 10);
}

// The reference of a target that slows down is that of the same target at full pace, later: at each
// point of the path. Both are compared where the path has whole periods. Samples between two ticks
// are interpolated, which errs by at most 0.9 m/s² (1 ms)²/8 = 0.11 µm, and the lead of the second
// derivative amplifies that by a₂/T² = 320. A lead in wall time would err by 15 mm.
TEST(AdaptiveInverse, SendsTheSameReferenceAlongThePathOfATargetThatSlowsDown) {
  AdaptiveInverse full{linear_settings()}, slow{linear_settings()};
  std::vector<double> expected;
  for (int tick = 0; tick < 1'200; ++tick)
    expected.push_back(full.step(motion_at(tick), 0, 0, 1, false));

  double path = -1, last_path = 0, last = 0;
  int compared = 0;
  for (int tick = 0; tick < 1'200; ++tick) {
    const double share = tick == 0 ? 1 : pace_at(tick);
    path += share;
    const double reference = slow.step(motion_at(path), 0, 0, 1, false, {share, 1});
    const double point = std::floor(path);
    if (tick > 1'000 && point > last_path) {
      const double weight = (point - last_path) / (path - last_path);
      EXPECT_NEAR(last + weight * (reference - last), expected[static_cast<std::size_t>(point)],
                  4e-5)
          << tick;
      ++compared;
    }
    last_path = path;
    last = reference;
  }
  EXPECT_GT(compared, 100);
}

// A command on time has its whole lead, to the last bit.
TEST(PaceMeter, LeavesOutCurvatureAfterAWaitAndReturnsToAllOfIt) {
  PaceMeter meter;
  const auto pass = [&](int ticks, double lost_time) {
    Pace pace;
    for (int i = 0; i < ticks; ++i) pace = meter(lost_time, kPeriod);
    return pace;
  };
  EXPECT_EQ(pass(10, 0).curvature, 1);

  Pace waiting;
  for (int tick = 1; tick <= 50; ++tick) waiting = pass(1, tick * kPeriod);

  EXPECT_NEAR(waiting.share, 0, 1e-12);
  EXPECT_NEAR(waiting.curvature, 0.3, 1e-3);
  EXPECT_NEAR(pass(200, 50 * kPeriod).curvature, 1 - 0.7 * std::exp(-1), 2e-3);
  EXPECT_EQ(pass(2000, 50 * kPeriod).curvature, 1);
}

// The velocity is a backward difference, half a period late.
TEST(AdaptiveInverse, WithoutCurvatureLeadsByVelocityAlone) {
  AdaptiveInverseSettings settings = linear_settings();
  AdaptiveInverse inverse{settings};
  constexpr double kAcceleration = 2;  // [m/s²]
  double x = 0, reference = 0, velocity = 0;
  for (int tick = 0; tick < 300; ++tick) {
    velocity = kAcceleration * tick * kPeriod;
    x = velocity * velocity / (2 * kAcceleration);
    reference = inverse.step(x, x, 0, 1, false, {.curvature = 0});
  }
  velocity -= kAcceleration * kPeriod / 2;
  EXPECT_NEAR(reference, settings.initial.a0 * x + settings.initial.a1 * velocity, 1e-6);
}

TEST(AdaptiveInverse, RefusesSettingsOutOfRange) {
  const auto refused = [](auto change) {
    AdaptiveInverseSettings settings;
    change(settings);
    EXPECT_THROW(AdaptiveInverse{settings}, Error);
  };
  refused([](auto& s) { s.period = 0; });
  refused([](auto& s) { s.initial.a2 = 1e-5; });  // inverts an unstable machine
  refused([](auto& s) { s.initial.a3 = 1e-7; });  // faster than the period
  refused([](auto& s) { s.uncertainty.load = -1; });
  refused([](auto& s) { s.initial.load = std::numeric_limits<double>::quiet_NaN(); });
  refused([](auto& s) { s.largest_reference = 0; });
}

TEST(AdaptiveInverse, WorksInRealTime) {
  AdaptiveInverse inverse{AdaptiveInverseSettings{}};
  const auto second = [&] {
    for (int i = 0; i < 2'000; ++i)  // learns and solves
      (void)inverse.step(learnt_target(i * kPeriod), learnt_target(i * kPeriod - 0.05), 1e5, 1,
                         true);
  };

  EXPECT_REALTIME(second());
}

}  // namespace
}  // namespace rths::controller
