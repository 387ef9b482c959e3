// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/controller/lag_correction.hpp>
#include <rths/core/error.hpp>

#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

constexpr double kWeight = 9.7e6;  // [N]

/// An axis that answers with a gain and a delay of whole samples.
class LateAxis {
 public:
  LateAxis(double gain, std::size_t samples) : gain_{gain}, line_(samples, 0.0) {}
  double operator()(double command) {
    line_.push_back(gain_ * command);
    const double late = line_.front();
    line_.pop_front();
    return late;
  }

 private:
  double gain_;
  std::deque<double> line_;
};

TEST(LagCorrection, LearnsGainAndLag) {
  LagCorrection correction{{}};
  LateAxis axis{0.9, 3};
  double worst = 0;

  for (int i = 0; i < 4000; ++i) {
    const double command = 1e6 * std::sin(2 * std::numbers::pi * 2 * i * kPeriod);
    const double corrected = correction.step(command, kWeight + axis(command));
    if (i > 2000) worst = std::max(worst, std::abs(corrected - kWeight - command));
  }

  // A lag of 3 ms is a gain of cos ωτ and a difference of sin ωτ/ω, half a sample late.
  const double angle = 2 * std::numbers::pi * 2 * 3 * kPeriod;
  EXPECT_NEAR(correction.gain(), 0.9 * std::cos(angle), 0.002);
  EXPECT_NEAR(correction.lag(), 0.9 * 3 * kPeriod, 2e-5);
  EXPECT_LT(worst, 1e3);  // uncorrected: 1e5
}

TEST(LagCorrection, LearnsNothingAtRest) {
  LagCorrection correction{{.lag = 1e-3}};
  std::mt19937_64 random{11};
  std::normal_distribution<double> noise{0, 15e3};

  for (int i = 0; i < 10'000; ++i) static_cast<void>(correction.step(0, kWeight + noise(random)));

  EXPECT_DOUBLE_EQ(correction.gain(), 1);
  EXPECT_DOUBLE_EQ(correction.lag(), 1e-3);
}

// The step of the measurement has no counterpart in the command.
TEST(LagCorrection, KeepsAForceThatTheCommandDoesNotExplain) {
  LagCorrection correction{{}};
  double corrected = 0;

  for (int i = 0; i < 1000; ++i)
    corrected = correction.step(0, kWeight + (i > 100 ? 2e5 : 0), false);

  EXPECT_NEAR(corrected, kWeight + 2e5, 1);
}

/// A mass on a specimen, released from 1 mm: 9.5 Hz, damping 1 %. Its specimen's force answers with
/// 95 % after 1 ms.
/// @param correction  null: none   @param is_early  it knows the command of the period before only
/// @returns the ratio of the largest displacements in the eighth and sixth second
double growth(LagCorrection* correction, bool is_early = false) {
  constexpr double kMass = 1.4e6, kOmega = 2 * std::numbers::pi * 9.5, kDamping = 0.01;
  const double stiffness = kMass * kOmega * kOmega;
  LateAxis axis{0.95, 1};
  double x = 1e-3, v = 0, sixth = 0, eighth = 0, command = 0, before = 0;
  for (int i = 0; i < 8000; ++i) {
    const double measured = axis(command);
    const double force =
        correction == nullptr ? measured : correction->step(is_early ? before : command, measured);
    before = command;
    v += kPeriod * (-force / kMass - 2 * kDamping * kOmega * v);
    x += kPeriod * v;
    command = stiffness * x;
    if (i >= 5000 && i < 6000) sixth = std::max(sixth, std::abs(x));
    if (i >= 7000) eighth = std::max(eighth, std::abs(x));
  }
  return eighth / sixth;
}

// Without delay, the amplitude falls by exp(−ζω · 2 s) = 0.303 in two seconds. A delay τ adds −ωτ/2
// to ζ: then it grows by exp(2.4) = 10.6, with a stiffness of 95 %.
TEST(LagCorrection, ReturnsTheDampingThatALateForceTakes) {
  const double omega = 2 * std::numbers::pi * 9.5;

  LagCorrection correction{{}};
  EXPECT_GT(growth(nullptr), 5);
  EXPECT_NEAR(growth(&correction), std::exp(-0.01 * omega * 2), 0.01);
}

// The extrapolation errs by T² c̈, which is in phase with c and takes no damping.
TEST(LagCorrection, AnswersACommandThatIsAhead) {
  const double omega = 2 * std::numbers::pi * 9.5;

  LagCorrection late{{}}, ahead{{.ahead = kPeriod}};
  EXPECT_GT(growth(&late, true), 5);
  EXPECT_NEAR(growth(&ahead, true), std::exp(-0.01 * omega * 2), 0.02);
}

TEST(LagCorrection, HoldsItsForceOnBadSamples) {
  LagCorrection correction{{}};
  static_cast<void>(correction.step(0, kWeight));
  const double before = correction.step(1e5, kWeight + 1e5);

  EXPECT_EQ(correction.step(std::numeric_limits<double>::quiet_NaN(), kWeight), before);
  EXPECT_EQ(correction.step(1e5, std::numeric_limits<double>::infinity()), before);
  EXPECT_TRUE(std::isfinite(correction.step(1e5, kWeight + 1e5)));
}

TEST(LagCorrection, RefusesSettingsThatAreNotPositive) {
  EXPECT_THROW(LagCorrection({.gain_uncertainty = 0}), Error);
  EXPECT_THROW(LagCorrection({.lag_uncertainty = -1}), Error);
  EXPECT_THROW(LagCorrection({.noise = 0}), Error);
  EXPECT_THROW(LagCorrection({.forgetting = 0}), Error);
  EXPECT_THROW(LagCorrection({.cutoff = 600}), Error);
  EXPECT_THROW(LagCorrection({.ahead = -1e-3}), Error);
}

TEST(LagCorrection, RunsInRealTime) {
  LagCorrection correction{{}};

  EXPECT_REALTIME(static_cast<void>(correction.step(1e3, 2e3)));
}

}  // namespace
}  // namespace rths::controller
