// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/sim/lead_rubber_design.hpp>

#include "support/files.hpp"

namespace rths::sim {
namespace {

// Round numbers, for hand calculations.
LeadRubberDesign round_design() {
  LeadRubberDesign d;
  d.outer_diameter = 1;
  d.lead_diameter = 0.2;
  d.rubber_layers = 20;
  d.layer_thickness = 0.01;
  d.shim_thickness = 0.005;
  d.shear_modulus = 1e6;
  d.characteristic_strength = 3e5;
  d.stiffness_ratio = 0.1;
  return d;
}

// Our design of the paper's bearing, as in sim/bearings/lprb.toml.
LeadRubberDesign paper_design() {
  LeadRubberDesign d;
  d.outer_diameter = 1.35;
  d.lead_diameter = 0.3586;
  d.rubber_layers = 25;
  d.layer_thickness = 0.01;
  d.shim_thickness = 0.005;
  d.shear_modulus = 796'400;
  d.characteristic_strength = 1.01e6;
  d.stiffness_ratio = 4.238095 / 358;
  return d;
}

void expect_about(double found, double expected) { EXPECT_NEAR(found, expected, 1e-6 * expected); }

TEST(LeadRubberDesign, HasTheGeometryOfItsDrawing) {
  const auto d = round_design();

  expect_about(rubber_area(d), 0.24 * std::numbers::pi);
  expect_about(lead_area(d), 0.01 * std::numbers::pi);
  expect_about(shape_factor(d), 24);  // 0.96/(4 · 0.01)
  expect_about(rubber_thickness(d), 0.2);
  expect_about(height(d), 0.295);
  expect_about(moment_of_inertia(d), std::numbers::pi / 64 * 0.9984);
  expect_about(radius_of_gyration(d), std::sqrt(1.04) / 4);  // √(D_2² + D_1²)/4
}

TEST(LeadRubberDesign, CountsItsCoverInAreasOnly) {
  auto d = round_design();
  d.cover = 0.1;

  expect_about(rubber_area(d), std::numbers::pi / 4 * (1.21 - 0.04));
  expect_about(shape_factor(d), 24);
}

TEST(LeadRubberDesign, HasTheStiffnessesOfAHandCalculation) {
  const auto d = round_design();

  expect_about(hole_factor(d), 26.0 / 16 - 1.5 / std::log(5.0));
  expect_about(compression_modulus(d), 9.22336284e8);  // 1/(1/2.395e9 + 2/3e9)
  expect_about(rotation_modulus(d), 9.22336284e8 / 3);
  expect_about(vertical_stiffness(d), 3.47712587e9);
  expect_about(post_yield_stiffness(d), 1.2e6 * std::numbers::pi);
  expect_about(initial_stiffness(d), 1.2e7 * std::numbers::pi);
  expect_about(yield_displacement(d), 3e5 / (1.08e7 * std::numbers::pi));
  expect_about(torsional_stiffness(d), 490'088.454);
  expect_about(rotational_stiffness(d), 7.53377272e7);
}

TEST(LeadRubberDesign, HasTheLoadsOfAHandCalculation) {
  const auto d = round_design();

  expect_about(euler_load(d), 2.52052056e9);
  expect_about(critical_load(d), 5.29446022e7);
  // The same load in terms of the rubber thickness alone: π √(E_r G I A)/T_r.
  expect_about(critical_load(d), std::numbers::pi *
                                     std::sqrt(rotation_modulus(d) * d.shear_modulus *
                                               moment_of_inertia(d) * rubber_area(d)) /
                                     rubber_thickness(d));
  expect_about(cavitation_force(d), 7.2e5 * std::numbers::pi);
}

TEST(LeadRubberDesign, NeedsNoLead) {
  auto d = round_design();
  d.lead_diameter = 0;
  const auto terms = terms_of(d);

  EXPECT_EQ(hole_factor(d), 1);
  EXPECT_TRUE(std::none_of(terms.begin(), terms.end(),
                           [](const auto& term) { return term.kind == "lead_heating"; }));
}

TEST(LeadRubberDesign, RefusesImpossibleDimensions) {
  auto wide = round_design();
  wide.lead_diameter = 1;
  auto soft = round_design();
  soft.shear_modulus = 0;

  EXPECT_THROW((void)terms_of(wide), Error);
  EXPECT_THROW((void)terms_of(soft), Error);
}

TEST(LeadRubberDesign, WithoutEffectsIsHysteresisOnALinearSpring) {
  const auto d = round_design();
  const LeadRubberEffects none{false, false, false, false, false};
  const Composition bearing{terms_of(d, none), 1e-3};
  std::vector<double> state(bearing.states());
  Quantities<double> q;
  q.displacement[0] = 0.3;
  q.vertical_displacement = 0.01;
  bearing.advance(state, q);

  EXPECT_NEAR(q.force[0], 3e5 + 0.3 * post_yield_stiffness(d), 1);
  EXPECT_NEAR(q.axial_load, -0.01 * vertical_stiffness(d), 1);
}

TEST(LeadRubberDesign, WithAllEffectsIsSofterUnderLoadAndDisplacement) {
  const auto d = round_design();
  const Composition bearing{terms_of(d), 1e-3};
  std::vector<double> state(bearing.states());
  Quantities<double> q;
  q.displacement[0] = 0.3;
  q.vertical_displacement = -1e-3;
  bearing.advance(state, q);
  const double vertical = vertical_stiffness(d) /
                          (1 + 3 * 0.09 / std::pow(std::numbers::pi * radius_of_gyration(d), 2));
  const double angle = 2 * std::acos(0.3);
  const double critical = critical_load(d) * (angle - std::sin(angle)) / std::numbers::pi;
  const double ratio = 1e-3 * vertical / critical;

  EXPECT_NEAR(q.axial_load, 1e-3 * vertical, 1);
  EXPECT_NEAR(q.force[0], 3e5 + 0.3 * post_yield_stiffness(d) * (1 - ratio * ratio), 1);
}

// Compares the file's parameters with the design's, including those of disabled terms.
TEST(LeadRubberDesign, OfThePapersBearingAgreesWithItsFile) {
  const auto file = Config::load(test::source_tree() / "sim/bearings/lprb.toml");
  const auto d = paper_design();

  EXPECT_NEAR(lead_area(d) * 10e6, d.characteristic_strength, 1e-3 * d.characteristic_strength);
  for (const auto& term : terms_of(d)) {
    const Config table = file.table(term.kind);
    for (const auto& parameter : term_kind(term.kind).parameters) {
      const std::string key = parameter_key(parameter, SensorChannel::Force);
      if (!table.has(key)) continue;
      const auto derived =
          std::find_if(term.parameters.begin(), term.parameters.end(),
                       [&](const auto& pair) { return pair.first == parameter.name; });
      ASSERT_NE(derived, term.parameters.end()) << key;
      EXPECT_NEAR(table.number(key), derived->second, 1e-3 * derived->second) << key;
    }
  }
}

// Pushed slowly to the design displacement, without heating of the lead.
TEST(LeadRubberDesign, OfThePapersBearingHasItsForce) {
  auto terms = read_terms(Config::load(test::source_tree() / "sim/bearings/lprb.toml"));
  std::erase_if(terms, [](const auto& term) { return term.kind == "lead_heating"; });
  const Composition bearing{terms, 1e-2};
  std::vector<double> state(bearing.states());
  Quantities<double> q;
  for (int i = 1; i <= 210; ++i) {
    q = {};
    q.displacement[0] = i * 1e-3;
    bearing.advance(state, q);
  }

  EXPECT_NEAR(q.force[0], 1.900e6, 1e3);
}

}  // namespace
}  // namespace rths::sim
