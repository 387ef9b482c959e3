// SPDX-License-Identifier: Apache-2.0
// Confidence intervals have their stated coverage: over repetitions with different noise, about 95
// % contain the true value, and they are no wider than necessary.
#include <rths/verdict/diagnose.hpp>

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <rths/identification/constants.hpp>

#include "support/long_run.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kRecordLength = 20, kRest = 2;             // [s]
constexpr double kTrueStiffness = 2e5, kTrueDamping = 3e3;  // [N/m], [N·s/m]
constexpr double kTrueDrag = 4e3;                           // the missing term [N·s²/m²]
constexpr double kForceNoise = 20, kMotionNoise = 2e-6;     // [N], [m]
// The fastest motion has 1.1 Hz.
const double kSampleStep = test::is_long() ? 0.004 : 0.008;  // [s]
const int kSamples = static_cast<int>(kRecordLength / kSampleStep);
constexpr int kRepetitions = 20;
constexpr double kFitPhase = 1, kSecondPhase = 4, kUnseenPhase = 9;

struct GuideState {
  double displacement = 0, velocity = 0;  // [m], [m/s]
};

// With an analytic velocity.
GuideState guide_state(int sample, double phase) {
  const double t = std::max(0.0, sample * kSampleStep - kRest);
  const double rise = 1 - std::exp(-t * t / 4), slope = t / 2 * std::exp(-t * t / 4);
  GuideState state;
  for (const double frequency : {0.3, 0.7, 1.1}) {
    const double w = 2 * std::numbers::pi * frequency, a = w * t + phase * frequency;
    state.displacement += 0.03 * rise * std::sin(a);
    state.velocity += 0.03 * (rise * w * std::cos(a) + slope * std::sin(a));
  }
  return state;
}

double drag_at(const GuideState& state) { return std::abs(state.velocity) * state.velocity; }

// A spring, a damper and c |v| v.
Record record_of(const std::string& name, Use use, double phase, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Record record;
  record.name = name;
  record.use = use;
  record.time_step = kSampleStep;
  Channel u{"displacement.long", "m", {}}, f{"force.long", "N", {}};
  for (int k = 0; k < kSamples; ++k) {
    const GuideState state = guide_state(k, phase);
    u.values.push_back(state.displacement + kMotionNoise * normal(random));
    f.values.push_back(kTrueStiffness * state.displacement + kTrueDamping * state.velocity +
                       kTrueDrag * drag_at(state) + kForceNoise * normal(random));
  }
  record.channels = {u, f};
  record.quiet = {0, static_cast<std::size_t>(kRest / kSampleStep)};
  return record;
}

Case case_of(unsigned seed) {
  std::mt19937 random{seed};
  Case c;
  c.name = "guide";
  c.records = {record_of("fit", Use::Fit, kFitPhase, random),
               record_of("second", Use::HeldOut, kSecondPhase, random),
               record_of("unseen", Use::HeldOut, kUnseenPhase, random)};
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      "[polynomial_stiffness]\naxes = [\"long\"]\nlinear_N_per_m = 210_000\n"
      "[viscous_friction]\naxes = [\"long\"]\ncoefficient_N_s_per_m = 2_500\n",
      "model");
  c.model.fitted = {{"polynomial_stiffness.linear", std::nullopt},
                    {"viscous_friction.coefficient", std::nullopt}};
  return c;
}

// Of the drag, if the force has an error of up to kMaterial of its deviation that looks like the
// part of the drag that spring and damper cannot reproduce.
double systematic_deviation() {
  Eigen::MatrixXd linear(2 * kSamples, 2);
  Eigen::VectorXd drag(2 * kSamples);
  Eigen::Index row = 0;
  for (const double phase : {kFitPhase, kSecondPhase})
    for (int k = 0; k < kSamples; ++k, ++row) {
      const GuideState state = guide_state(k, phase);
      linear.row(row) << state.displacement, state.velocity;
      drag[row] = drag_at(state);
    }
  const Eigen::VectorXd force =
      linear * Eigen::Vector2d{kTrueStiffness, kTrueDamping} + kTrueDrag * drag;
  const Eigen::Vector2d absorbed =
      (linear.transpose() * linear).inverse() * linear.transpose() * drag;
  return kMaterial / std::sqrt(3.0) * (force.array() - force.mean()).matrix().norm() /
         (drag - linear * absorbed).norm();
}

TEST(Intervals, HaveTheirStatedCoverageAndAreNotTooWide) {
  // P(15 or fewer of 20 | 0.95) = 0.26 %, by the binomial distribution.
  constexpr int kFewest = 16;
  int held = 0;
  double half = 0, square = 0;
  for (unsigned seed = 1; seed <= kRepetitions; ++seed) {
    const Verdict verdict = diagnose(case_of(seed));
    ASSERT_EQ(verdict.conclusion.causes.size(), 1U) << verdict.sentence;
    ASSERT_EQ(verdict.conclusion.causes[0].name, "quadratic_drag") << verdict.sentence;
    const Estimate& drag = verdict.conclusion.causes[0].parameters[0];
    held += drag.low <= kTrueDrag && kTrueDrag <= drag.high ? 1 : 0;
    half += (drag.high - drag.low) / 2 / kRepetitions;
    square += std::pow(drag.value - kTrueDrag, 2) / kRepetitions;
  }

  EXPECT_GE(held, kFewest);
  // The root mean square of 20 errors is at least 1/1.84 of their deviation in 99.9 of 100 cases
  // (χ² of 20 degrees of freedom is at least 5.9). Intervals may be a quarter wider than that, and
  // contain the systematic error.
  EXPECT_LT(half, 1.25 * 1.96 * std::hypot(1.84 * std::sqrt(square), systematic_deviation()));
}

}  // namespace
}  // namespace rths::diagnosis
