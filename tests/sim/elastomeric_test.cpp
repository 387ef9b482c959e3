// SPDX-License-Identifier: Apache-2.0
// Terms of elastomeric bearings against closed forms; lead_heating_test.cpp tests heating.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/sim/composition.hpp>

namespace rths::sim {
namespace {

using std::numbers::pi;

constexpr double kVerticalStiffness = 5e9;  // vertical [N/m]
constexpr double kCavitation = 3.2e6;       // [N]
constexpr double kDecay = 10;               // [1/m]
constexpr double kThickness = 0.25;         // [m]
constexpr double kOnset = kCavitation / kVerticalStiffness;

// A composition with its state.
class RubberBearing {
 public:
  explicit RubberBearing(const std::vector<TermSettings>& terms)
      : composition_{terms, 1e-3}, state_(composition_.states()) {}

  Quantities<double> move(double u, double w = 0, double load = 0) {
    Quantities<double> q;
    q.displacement[0] = u;
    q.vertical_displacement = w;
    q.axial_load = load;
    return step(q);
  }
  Quantities<double> step(Quantities<double> q) {
    composition_.advance(state_, q);
    return q;
  }

 private:
  Composition composition_;
  std::vector<double> state_;
};

TermSettings axial(double damage = 0.5) {
  return {"elastomeric_axial",
          "",
          {{"vertical_stiffness", kVerticalStiffness},
           {"cavitation_force", kCavitation},
           {"post_cavitation_decay", kDecay},
           {"rubber_thickness", kThickness},
           {"cavitation_damage", damage},
           {"buckled_stiffness_ratio", 1e-4}}};
}

double cavitated(double w) {
  return kCavitation * (1 + (1 - std::exp(-kDecay * (w - kOnset))) / (kDecay * kThickness));
}

TEST(ElastomericAxial, PullsAlongTheEnvelopeOfCavitation) {
  RubberBearing bearing{{axial()}};
  for (int i = 1; i <= 1000; ++i) {
    const double w = i * 1e-4;
    const double expected = w < kOnset ? kVerticalStiffness * w : cavitated(w);
    ASSERT_NEAR(-bearing.move(0, w).axial_load, expected, 1e-9 * expected) << w;
  }
}

// After cavitation to w_m: elastic up to the damaged strength, a straight line to the earlier peak,
// then the envelope.
TEST(ElastomericAxial, RemembersCavitationAsDamage) {
  const double damage = 0.5, largest = 0.02;
  RubberBearing bearing{{axial(damage)}};
  bearing.move(0, largest);
  const double left = kCavitation * (1 - damage * (1 - std::exp(-(largest - kOnset) / kOnset)));
  const double knee = left / kVerticalStiffness;
  const double slope = (cavitated(largest) - left) / (largest - knee);

  EXPECT_NEAR(-bearing.move(0, 0.5 * knee).axial_load, 0.5 * left, 1e-9 * left);
  EXPECT_NEAR(-bearing.move(0, 0.01).axial_load, left + slope * (0.01 - knee), 1e-9 * left);
  EXPECT_NEAR(-bearing.move(0, largest).axial_load, cavitated(largest), 1e-9 * left);
  EXPECT_NEAR(-bearing.move(0, 0.03).axial_load, cavitated(0.03), 1e-9 * left);
  EXPECT_NEAR(bearing.move(0, -1e-3).axial_load, 1e-3 * kVerticalStiffness, 1e-9 * left);
}

TEST(ElastomericAxial, CanPullElastically) {
  auto elastic = axial();
  elastic.parameters[1].second = 0;
  RubberBearing bearing{{elastic}};

  EXPECT_NEAR(-bearing.move(0, 0.01).axial_load, 0.01 * kVerticalStiffness, 1e-6);
}

TEST(ElastomericAxial, DampsVerticalMotion) {
  RubberBearing bearing{
      {{"elastomeric_axial",
        "",
        {{"vertical_stiffness", kVerticalStiffness}, {"vertical_damping", 2e7}}}}};
  Quantities<double> q;
  q.vertical_displacement = -1e-3;
  q.vertical_velocity = -0.05;  // shortening

  EXPECT_NEAR(bearing.step(q).axial_load, 1e-3 * kVerticalStiffness + 0.05 * 2e7, 1e-6);
}

// Overlap of two circles of diameter D displaced by u, divided by their area.
double overlap(double ratio) {
  return (2 * std::acos(ratio) - std::sin(2 * std::acos(ratio))) / pi;
}

TEST(ElastomericAxial, PushesAlongTheEnvelopeOfBuckling) {
  const double critical = 9e7, diameter = 1.35;
  RubberBearing bearing{{axial(),
                         {"buckling_load_variation",
                          "",
                          {{"critical_load", critical}, {"outer_diameter", diameter}}}}};
  for (const double u : {0.0, 0.1, 0.21, 0.5, 0.9, 1.2, 1.35, 2.0}) {
    const double ratio = u < diameter ? std::max(0.2, overlap(u / diameter)) : 0.2;
    const double buckles = ratio * critical;
    for (const double w : {-1e-3, -0.01, -0.03}) {
      const double elastic = -w * kVerticalStiffness;
      const double expected = elastic < buckles ? elastic : buckles + 1e-4 * (elastic - buckles);
      EXPECT_NEAR(bearing.move(u, w).axial_load, expected, 1e-9 * critical) << u << ", " << w;
    }
  }
}

TEST(VerticalStiffnessVariation, HalvesTheStiffnessWhereTheFormulaDoes) {
  const double gyration = 0.35;
  RubberBearing bearing{
      {axial(), {"vertical_stiffness_variation", "", {{"radius_of_gyration", gyration}}}}};
  const double u = pi / std::sqrt(3.0) * gyration;

  EXPECT_NEAR(bearing.move(u, -1e-3).axial_load, 0.5e-3 * kVerticalStiffness, 1e-6);
  EXPECT_NEAR(bearing.move(0, -1e-3).axial_load, 1e-3 * kVerticalStiffness, 1e-6);
}

TermSettings rubber(double stiffness = 4e6) {
  return {"bouc_wen", "", {{"post_yield_stiffness", stiffness}}};
}
TermSettings lead(double strength = 1e6, double beta = 0.5) {
  return {
      "bouc_wen",
      "",
      {{"characteristic_strength", strength}, {"yield_displacement", 2.855e-3}, {"beta", beta}}};
}

// The stiffness depends on the axial load and the buckling load of the same step.
TEST(HorizontalStiffnessVariation, UsesLoadAndBucklingLoadOfTheSameStep) {
  const double critical = 2e7, u = 0.3, diameter = 1.35;
  RubberBearing bearing{{rubber(),
                         {"horizontal_stiffness_variation", "", {{"coefficient", 1}}},
                         axial(),
                         {"buckling_load_variation",
                          "",
                          {{"critical_load", critical}, {"outer_diameter", diameter}}}}};
  const double load = 1.5e-3 * kVerticalStiffness;
  const double ratio = load / (critical * overlap(u / diameter));

  EXPECT_NEAR(bearing.move(u, -1.5e-3).force[0], 4e6 * u * (1 - ratio * ratio), 1e-3);
}

TEST(HorizontalStiffnessVariation, NeverMakesTheStiffnessNegative) {
  RubberBearing bearing{{rubber(),
                         {"horizontal_stiffness_variation", "", {{"coefficient", 1}}},
                         {"buckling_load_variation", "", {{"critical_load", 1e7}}}}};

  EXPECT_EQ(bearing.move(0.1, 0, 1.2e7).force[0], 0);
}

TEST(Modifiers, FollowTheAxialLoad) {
  RubberBearing bearing{
      {rubber(),
       {"axial_load_strength", "", {{"coefficient", 0.2}, {"reference_load", 1e7}}},
       {"axial_load_stiffness", "", {{"coefficient", 0.1}, {"reference_load", 1e7}}}}};
  const auto q = bearing.move(0.1, 0, 1.5e7);

  EXPECT_NEAR(q.strength, 1.1, 1e-12);
  EXPECT_NEAR(q.stiffness, 1 - 0.1 * 1.25, 1e-12);
  EXPECT_EQ(bearing.move(0.1, 0, -9e7).strength, 0);
}

TEST(Scragging, LosesItsExcessWithPeakDisplacementForGood) {
  RubberBearing bearing{
      {rubber(), {"scragging", "", {{"virgin_excess", 0.2}, {"scragging_displacement", 0.05}}}}};

  EXPECT_NEAR(bearing.move(0).stiffness, 1.2, 1e-12);
  EXPECT_NEAR(bearing.move(-0.1).stiffness, 1 + 0.2 * std::exp(-2), 1e-12);
  EXPECT_NEAR(bearing.move(0.02).stiffness, 1 + 0.2 * std::exp(-2), 1e-12);
}

TEST(Modifiers, FollowVelocityAgeAndTemperature) {
  RubberBearing bearing{
      {lead(),
       {"rate_dep_strength", "", {{"coefficient", 0.05}, {"reference_velocity", 0.05}}},
       {"ageing_temperature",
        "",
        {{"stiffness_ageing", 0.1},
         {"strength_ageing", 0.02},
         {"stiffness_temperature", 0.004},
         {"strength_temperature", 0.007}}}}};
  Quantities<double> q;
  q.velocity = {0.03, 0.04};
  q.temperature = -10;
  const auto after = bearing.step(q);

  EXPECT_NEAR(after.strength, (1 + 0.05 * std::log(2)) * 1.02 * std::exp(0.07), 1e-12);
  EXPECT_NEAR(after.stiffness, 1.1 * std::exp(0.04), 1e-12);
}

TEST(Restoring, FollowsItsFormulas) {
  RubberBearing bearing{{{"large_strain_stiffening", "", {{"stiffness", 2e6}, {"onset", 0.2}}}}};
  RubberBearing cubic{{{"cubic_stiffness", "", {{"stiffness", 2e7}}}}};
  RubberBearing asymmetric{{{"asymmetric_stiffness", "", {{"stiffness", 1e6}}}}};
  RubberBearing p_delta{{{"p_delta", "", {{"coefficient", -0.5}, {"height", 0.4}}}}};
  RubberBearing viscous{{{"viscous_damping", "", {{"damping", 1e5}}}}};
  Quantities<double> q;
  q.displacement = {0.3, -0.4};
  q.velocity = {0.1, 0.2};
  q.axial_load = 8e6;

  EXPECT_NEAR(bearing.step(q).force[0], 2e6 * 0.3 * 0.6, 1e-6);
  EXPECT_EQ(bearing.move(0.19).force[0], 0);
  EXPECT_NEAR(cubic.step(q).force[1], -2e7 * 0.25 * 0.4, 1e-6);
  EXPECT_NEAR(asymmetric.step(q).force[1], 1e6 * 0.16, 1e-6);
  EXPECT_NEAR(p_delta.step(q).force[0], -0.5 * 8e6 * 0.3 / 0.4, 1e-6);
  EXPECT_NEAR(viscous.step(q).force[1], 2e4, 1e-6);
}

// A ramp of speed v gives F = k v tau (1 - exp(-t/tau)), which relaxes when held; exact at any
// step.
TEST(ViscoelasticRelaxation, RisesAndRelaxesExactly) {
  const double k = 1e6, tau = 0.5, v = 0.2;
  RubberBearing bearing{
      {{"viscoelastic_relaxation", "", {{"stiffness", k}, {"relaxation_time", tau}}}}};
  double held = 0;
  for (int i = 1; i <= 2000; ++i) {
    const double t = i * 1e-3;
    const double force = bearing.move(v * std::min(t, 1.0)).force[0];
    const double ramp = k * v * tau * (1 - std::exp(-t / tau));
    if (i == 1000) held = force;
    const double expected = i <= 1000 ? ramp : held * std::exp(-(t - 1) / tau);
    ASSERT_NEAR(force, expected, 1e-9 * k * v * tau) << t;
  }
}

// After a reversal z returns from 1 along dz = (1 + kappa z²) du/u_y, kappa = 2 beta - 1, and then
// follows tanh. The work of a half cycle of length 2 D is Q times
//     2 D - u_y (atan(√kappa)/√kappa + ln(1 + kappa)/(2 kappa) + ln 2).
TEST(BoucWen, DissipatesTheWorkOfItsLawPerCycle) {
  const double D = 0.21, Q = 1e6, u_y = 2.855e-3, beta = 0.9, kappa = 2 * beta - 1;
  RubberBearing bearing{{lead(Q, beta)}};
  double energy = 0, force = 0, before = 0;
  const int steps = 20'000;
  for (int i = 1; i <= 2 * steps; ++i) {
    const double u = D * std::sin(2 * pi * (i + 0.25 * steps) / steps) * std::min(1.0, 1e-2 * i);
    const double now = bearing.move(u).force[0];
    if (i > steps) energy += 0.5 * (now + force) * (u - before);
    force = now;
    before = u;
  }
  const double root = std::sqrt(kappa);
  const double lost =
      u_y * (std::atan(root) / root + std::log1p(kappa) / (2 * kappa) + std::log(2.0));
  EXPECT_NEAR(energy, 2 * Q * (2 * D - lost), 1e-5 * energy);
}

}  // namespace
}  // namespace rths::sim
