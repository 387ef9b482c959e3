// SPDX-License-Identifier: Apache-2.0
// A guide on two axes with a law on one of them, or on both. Formulas of this file, independent of
// the library, add the law.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/verdict/diagnose.hpp>

#include "one_axis.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kStiffness = 2e5, kDamping = 3e3;  // [N/m], [N·s/m]

struct Law {
  double friction = 0, drag = 0;  // [N], [N·s²/m²]
  double range = 1e9;             // of the load cell [N]
  double damping = kDamping;      // [N·s/m]
};

Record record_of(Use use, unsigned seed, const Law& law) {
  double side = 0, before = 0;
  const auto guide = [&](double, double x, double v) {
    // Coulomb friction with 0.1 mm of presliding: Dahl's law, solved exactly for each step.
    const double way = x - before, direction = way > 0 ? 1 : -1;
    side = direction + (side - direction) * std::exp(-std::abs(way) / 1e-4);
    before = x;
    const double force =
        kStiffness * x + law.damping * v + law.friction * side + law.drag * std::abs(v) * v;
    return std::clamp(force, -law.range, law.range);
  };
  return test_support::record_of("", use, seed, guide, {.length = test_support::kShortLength});
}

// @param damping  as the case states it: one value, or one for each axis [N·s/m]
Verdict verdict_on(const Law& longitudinal, const Law& lateral,
                   const std::string& damping = "2_500") {
  Case c;
  c.name = "guide on two axes";
  for (unsigned k = 0; k < 3; ++k) {
    const Use use = k == 0 ? Use::Fit : Use::HeldOut;
    Record record = record_of(use, k + 1, longitudinal);
    record.name = std::string{"record "} + std::to_string(k);
    for (auto& channel : record_of(use, k + 10, lateral).channels) {
      channel.role.replace(channel.role.find("long"), 4, "lat");
      record.channels.push_back(channel);
    }
    c.records.push_back(record);
  }
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      "[polynomial_stiffness]\nlinear_N_per_m = 210_000\n"
      "[viscous_friction]\ncoefficient_N_s_per_m = " +
          damping +
          "\n"
          "[force_offset]\nkind = \"offset\"\nchannel = \"force\"\noffset_N = 0\n",
      "model");
  for (const char* name :
       {"polynomial_stiffness.linear", "viscous_friction.coefficient", "force_offset.offset"})
    c.model.fitted.push_back({name, std::nullopt});
  Verdict verdict = diagnose(c);
  std::printf("  %s\n  %.1f s\n", verdict.sentence.c_str(), verdict.seconds);
  return verdict;
}

// The first cause, and the axis in the lines that would add it to the model; "": both.
void expect(const Verdict& verdict, const std::string& name, const std::string& axis) {
  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  ASSERT_FALSE(verdict.conclusion.causes.empty()) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.causes[0].name, name) << verdict.sentence;
  for (const std::string one : {"long", "lat"}) {
    const bool is_there =
        verdict.improvement.fragment.find("axes = [\"" + one + "\"]") != std::string::npos;
    EXPECT_EQ(is_there, one == axis) << verdict.improvement.fragment;
  }
}

TEST(TwoAxes, HaveFrictionOnOneOfThem) {
  expect(verdict_on({.friction = 300}, {}), "coulomb_friction", "long");
}

TEST(TwoAxes, HaveDragOnOneOfThem) {
  expect(verdict_on({}, {.drag = 3000}), "quadratic_drag", "lat");
}

// Slack may be named besides: the comparison's filter rounds the corners of the clipped force.
TEST(TwoAxes, HaveOneLoadCellThatSaturates) {
  expect(verdict_on({.range = 12'000}, {}), "force_saturation", "long");
}

TEST(TwoAxes, HaveTheSameLawOnBothIfTheGainIsTheSame) {
  expect(verdict_on({.drag = 3000}, {.drag = 3000}), "quadratic_drag", "");
  expect(verdict_on({.friction = 300}, {.friction = 500}), "coulomb_friction", "");
}

// Sensors' noise of 20 N leaves the damping uncertain by 1 N·s/m; one value for both axes would be
// wrong by 2000.
TEST(TwoAxes, HaveAParameterEachIfTheCaseStatesTwoValues) {
  const Verdict verdict = verdict_on({.damping = 2000}, {.damping = 6000}, "[2_500, 5_000]");

  EXPECT_EQ(verdict.conclusion.outcome, Outcome::None) << verdict.sentence;
  for (const auto& [name, damping] : {std::pair{"viscous_friction.long.coefficient", 2000.0},
                                      {"viscous_friction.lat.coefficient", 6000.0}}) {
    const auto found =
        std::find_if(verdict.evaluation.refitted.begin(), verdict.evaluation.refitted.end(),
                     [&](const auto& one) { return one.name == name; });
    ASSERT_NE(found, verdict.evaluation.refitted.end()) << name;
    EXPECT_NEAR(found->after, damping, 0.01 * damping) << name;
  }
}

}  // namespace
}  // namespace rths::diagnosis
