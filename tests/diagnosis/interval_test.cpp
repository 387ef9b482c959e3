// SPDX-License-Identifier: Apache-2.0
// Confidence intervals have their stated coverage: over repetitions with different noise, about 95
// % contain the true value, and they are no wider than necessary.
#include <rths/verdict/diagnose.hpp>

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "support/long_run.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kRecordLength = 20, kRest = 2;             // [s]
constexpr double kTrueStiffness = 2e5, kTrueDamping = 3e3;  // [N/m], [N·s/m]
constexpr double kTrueDrag = 4e3;                           // the missing term [N·s²/m²]
constexpr double kForceNoise = 20, kMotionNoise = 2e-6;     // [N], [m]
constexpr int kRepetitions = 20;

// The fastest motion has 1.1 Hz.
double sample_step() { return test::is_long() ? 0.004 : 0.008; }  // [s]

// A spring, a damper and c |v| v, with an analytic velocity.
Record record_of(const std::string& name, Use use, double phase, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double step = sample_step();
  Record record;
  record.name = name;
  record.use = use;
  record.time_step = step;
  Channel u{"displacement.long", "m", {}}, f{"force.long", "N", {}};
  for (int k = 0; k < static_cast<int>(kRecordLength / step); ++k) {
    const double t = std::max(0.0, k * step - kRest);
    const double rise = 1 - std::exp(-t * t / 4), slope = t / 2 * std::exp(-t * t / 4);
    double x = 0, v = 0;
    for (const double frequency : {0.3, 0.7, 1.1}) {
      const double w = 2 * std::numbers::pi * frequency, a = w * t + phase * frequency;
      x += 0.03 * rise * std::sin(a);
      v += 0.03 * (rise * w * std::cos(a) + slope * std::sin(a));
    }
    u.values.push_back(x + kMotionNoise * normal(random));
    f.values.push_back(kTrueStiffness * x + kTrueDamping * v + kTrueDrag * std::abs(v) * v +
                       kForceNoise * normal(random));
  }
  record.channels = {u, f};
  record.quiet = {0, static_cast<std::size_t>(kRest / step)};
  return record;
}

Case case_of(unsigned seed) {
  std::mt19937 random{seed};
  Case c;
  c.name = "guide";
  c.records = {record_of("fit", Use::Fit, 1, random), record_of("second", Use::HeldOut, 4, random),
               record_of("unseen", Use::HeldOut, 9, random)};
  c.model.kind = "platen";
  c.model.table = Config::parse(
      "[polynomial_stiffness]\naxes = [\"long\"]\nlinear_N_per_m = 210_000\n"
      "[viscous_friction]\naxes = [\"long\"]\ncoefficient_N_s_per_m = 2_500\n",
      "model");
  c.model.fitted = {{"polynomial_stiffness.linear", std::nullopt},
                    {"viscous_friction.coefficient", std::nullopt}};
  return c;
}

TEST(Intervals, HaveTheirStatedCoverageAndAreNotTooWide) {
  // P(15 or fewer of 20 | 0.95) = 0.26 %, by the binomial distribution.
  constexpr int kFewest = 16;
  int held = 0;
  double half = 0, square = 0;
  for (unsigned seed = 1; seed <= kRepetitions; ++seed) {
    const Verdict verdict = diagnose(case_of(seed));
    ASSERT_EQ(verdict.causes.size(), 1U) << verdict.sentence;
    ASSERT_EQ(verdict.causes[0].name, "quadratic_drag") << verdict.sentence;
    const Estimate& drag = verdict.causes[0].parameters[0];
    held += drag.low <= kTrueDrag && kTrueDrag <= drag.high ? 1 : 0;
    half += (drag.high - drag.low) / 2 / kRepetitions;
    square += std::pow(drag.value - kTrueDrag, 2) / kRepetitions;
  }

  EXPECT_GE(held, kFewest);
  // The root mean square of 20 errors is at least 1/1.84 of their deviation in 99.9 of 100 cases
  // (χ² of 20 degrees of freedom is at least 5.9). Intervals may be a quarter wider than that.
  EXPECT_LT(half, 1.25 * 1.84 * 1.96 * std::sqrt(square));
}

}  // namespace
}  // namespace rths::diagnosis
