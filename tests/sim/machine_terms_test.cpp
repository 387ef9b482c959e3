// SPDX-License-Identifier: Apache-2.0
// Terms between specimen and load cell, and between platen and specimen, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "sim/stepper.hpp"

namespace rths::sim {
namespace {

using test_support::kStep;
using test_support::spring;
using test_support::Stepper;

Quantities<double> moving(double u, double v, double load = 0) {
  Quantities<double> q;
  q.displacement = {u, 0};
  q.velocity = {v, 0};
  q.axial_load = load;
  return q;
}

double force_at(const TermSettings& term, double u, double v) {
  return Stepper{{term}, kStep}.step(moving(u, v)).force[0];
}

TEST(AsymmetricFriction, DiffersForwardsAndBackwards) {
  Stepper guide{{{"asymmetric_friction", "", {{"forward_force", 3e3}, {"backward_force", 5e3}}}},
                kStep};

  EXPECT_NEAR(guide.to(0.1).force[0], 3e3, 1e-6);
  EXPECT_NEAR(guide.to(0).force[0], -5e3, 1e-6);
}

TEST(LoadDependentFriction, FollowsTheLoadAndVanishesInUplift) {
  Stepper guide{{{"load_dependent_friction", "", {{"friction_coefficient", 0.002}}}}, kStep};

  EXPECT_NEAR(guide.step(moving(0.1, 1, 9e6)).force[0], 18e3, 1e-6);
  EXPECT_NEAR(guide.step(moving(0.2, 1, 3e6)).force[0], 6e3, 1e-6);
  EXPECT_EQ(guide.step(moving(0.3, 1, -3e6)).force[0], 0);
}

TEST(StribeckFriction, FallsFromBreakawayToCoulombWithVelocity) {
  const TermSettings guide{
      "stribeck_friction",
      "",
      {{"friction_force", 1e4}, {"breakaway_force", 5e3}, {"stribeck_velocity", 0.02}}};

  EXPECT_NEAR(force_at(guide, 0.1, 1e-6), 1.5e4, 1e-3);
  EXPECT_NEAR(force_at(guide, 0.1, 0.02), 1e4 + 5e3 * std::exp(-1), 1e-6);
  EXPECT_NEAR(force_at(guide, 0.1, 1), 1e4, 1e-6);
}

TEST(VelocityDependentFriction, IsHalfAtItsVelocityAndLevelsOff) {
  const TermSettings guide{
      "velocity_dependent_friction", "", {{"friction_force", 1e4}, {"growth_velocity", 0.02}}};

  EXPECT_NEAR(force_at(guide, 0.1, 0.02), 5e3, 1e-6);
  EXPECT_NEAR(force_at(guide, -0.1, -0.02), -5e3, 1e-6);
  EXPECT_NEAR(force_at(guide, 0.1, 0.38), 9.5e3, 1e-6);
}

TEST(PlanarFriction, OpposesTheMotionInEveryDirectionAndIsDahlAlongALine) {
  const double force = 1e4, presliding = 1e-3;
  const TermSettings guide{
      "planar_friction", "", {{"friction_force", force}, {"presliding", presliding}}};
  for (const double angle : {0.0, 0.4, 2.0, 4.5}) {
    Stepper stepper{{guide}, kStep};
    Quantities<double> q;
    const double x = std::cos(angle), y = std::sin(angle);
    q.displacement = {5e-4 * x, 5e-4 * y};
    auto result = stepper.step(q).force;
    EXPECT_NEAR(result[0], force * -std::expm1(-0.5) * x, 1e-6);
    EXPECT_NEAR(result[1], force * -std::expm1(-0.5) * y, 1e-6);
    q.displacement = {0.1 * x, 0.1 * y};
    result = stepper.step(q).force;
    EXPECT_NEAR(std::hypot(result[0], result[1]), force, 1e-6);
  }
}

TEST(PositionDependentFriction, ActsAroundOneDisplacement) {
  const TermSettings rub{"position_dependent_friction",
                         "",
                         {{"friction_force", 1e4}, {"place", 0.1}, {"width", 0.01}}};

  EXPECT_NEAR(force_at(rub, 0.1, 0), 1e4, 1e-6);
  EXPECT_NEAR(force_at(rub, 0.11, 0), 1e4 * std::exp(-1), 1e-6);
  EXPECT_LT(force_at(rub, 0.2, 0), 1e-6);
}

TEST(LinearStiffness, GrowsWithDisplacement) {
  const TermSettings spring{"linear_stiffness", "", {{"stiffness", 5e3}}};

  EXPECT_NEAR(force_at(spring, 0.1, 0.7), 500, 1e-9);
  EXPECT_NEAR(force_at(spring, -0.02, -0.3), -100, 1e-9);
}

TEST(Drag, GrowsWithItsPowerOfVelocity) {
  EXPECT_NEAR(force_at({"viscous_friction", "", {{"coefficient", 3e4}}}, 0, -0.5), -1.5e4, 1e-9);
  EXPECT_NEAR(force_at({"quadratic_drag", "", {{"coefficient", 3e4}}}, 0, -0.5), -7.5e3, 1e-9);
  const TermSettings damper{
      "asymmetric_viscous", "", {{"forward_coefficient", 1e4}, {"backward_coefficient", 4e4}}};
  EXPECT_NEAR(force_at(damper, 0, 0.5), 5e3, 1e-9);
  EXPECT_NEAR(force_at(damper, 0, -0.5), -2e4, 1e-9);
}

TEST(PowerDamping, IsAPowerOfVelocityAwayFromRest) {
  for (const double exponent : {0.3, 1.0, 2.5}) {
    const TermSettings damper{
        "power_damping", "", {{"force", 2e4}, {"exponent", exponent}, {"reference_velocity", 0.5}}};
    EXPECT_NEAR(force_at(damper, 0, 0.5), 2e4, 0.02);
    EXPECT_NEAR(force_at(damper, 0, -0.1), -2e4 * std::pow(0.2, exponent), 1);
    EXPECT_EQ(force_at(damper, 0, 0), 0);
  }
}

TEST(Springs, HaveTheShapeOfTheirEquations) {
  const TermSettings polynomial{
      "polynomial_stiffness", "", {{"linear", 2}, {"quadratic", 3}, {"cubic", 5}}};
  EXPECT_NEAR(force_at(polynomial, -2, 0), -4 + 12 - 40, 1e-12);
  // Modifiers of a specimen act on its spring as on the stiffness of its loop.
  const TermSettings scragged{
      "scragging", "", {{"virgin_excess", 0.5}, {"scragging_displacement", 2}}};
  const double factor = 1 + 0.5 * std::exp(-1);
  EXPECT_NEAR((Stepper{{polynomial, scragged}, kStep}.step(moving(-2, 0)).force[0]), -32 * factor,
              1e-12);
  const TermSettings piecewise{
      "piecewise_stiffness",
      "",
      {{"inside_stiffness", 10}, {"outside_stiffness", 3}, {"break_displacement", 0.5}}};
  EXPECT_NEAR(force_at(piecewise, -2, 0), -5 - 4.5, 1e-12);
  const TermSettings damper{
      "piecewise_damping",
      "",
      {{"slow_coefficient", 10}, {"fast_coefficient", 3}, {"break_velocity", 0.5}}};
  EXPECT_NEAR(force_at(damper, 0, 2), 5 + 4.5, 1e-12);
}

// Knots of the laws of displacement are at -1, -3/4 … 1 times the range, of those of velocity at 0,
// ±0.05, ±0.2, ±0.5, ±1 times.
TEST(TabulatedTerms, AreLinearBetweenKnotsAndConstantBeyond) {
  const auto table = [](const char* kind, double range) {
    TermSettings term{kind, "", {{"range", range}}};
    for (int i = 1; i <= 9; ++i) term.parameters.emplace_back("value_" + std::to_string(i), i * i);
    return term;
  };
  const TermSettings stiffness = table("tabulated_stiffness", 0.4);
  EXPECT_NEAR(force_at(stiffness, 0, 0), 25, 1e-12);
  EXPECT_NEAR(force_at(stiffness, 0.15, 0), (36 + 49) / 2.0, 1e-12);
  EXPECT_NEAR(force_at(stiffness, -1, 0), 1, 1e-12);
  const TermSettings damping = table("tabulated_damping", 2);
  EXPECT_NEAR(force_at(damping, 0, 0.7), (49 + 64) / 2.0, 1e-12);
  EXPECT_NEAR(force_at(damping, 0, -0.1), 16, 1e-12);
  EXPECT_NEAR(force_at(damping, 0, 5), 81, 1e-12);
  const TermSettings viscosity = table("tabulated_viscosity", 0.4);
  EXPECT_NEAR(force_at(viscosity, 0.1, -3), -3 * 36, 1e-12);
  TermSettings friction = table("tabulated_friction", 0.4);
  friction.parameters.emplace_back("creep_velocity", 0.1);
  EXPECT_NEAR(force_at(friction, 0.1, -0.2), 36 * std::tanh(-2), 1e-12);
}

TEST(GapContact, PushesBeyondItsGapAndNeverPulls) {
  const TermSettings stop{"gap_contact", "", {{"gap", 0.1}, {"stiffness", 1e7}, {"loss", 0.5}}};

  EXPECT_EQ(force_at(stop, 0.09, 1), 0);
  EXPECT_NEAR(force_at(stop, -0.11, -1), -1e5 * 1.5, 1e-6);
  EXPECT_NEAR(force_at(stop, 0.11, -1), 1e5 * 0.5, 1e-6);
  EXPECT_EQ(force_at(stop, 0.11, -3), 0);
}

TEST(TransducerBacklash, IsAPlayOperator) {
  const double k = 1e6, gap = 0.02;
  Stepper specimen{{spring(k), {"transducer_backlash", "", {{"gap", gap}}}}, kStep};

  EXPECT_EQ(specimen.to(0.01).force[0], 0);
  EXPECT_NEAR(specimen.to(0.05).force[0], k * 0.04, 1e-6);
  EXPECT_NEAR(specimen.to(0.031).force[0], k * 0.04, 1e-6);
  EXPECT_NEAR(specimen.to(-0.05).force[0], k * -0.04, 1e-6);
  EXPECT_NEAR(specimen.to(0).force[0], k * -0.01, 1e-6);
}

TEST(InputDeadZone, BlocksSmallDisplacements) {
  Stepper specimen{{spring(1e6), {"input_dead_zone", "", {{"half_width", 0.01}}}}, kStep};

  EXPECT_EQ(specimen.to(0.009).force[0], 0);
  EXPECT_NEAR(specimen.to(-0.03).force[0], -2e4, 1e-6);
}

TEST(SupportFlexibility, IsASpringInSeriesWithASpring) {
  const double k = 4e8, chi = 2e-9;
  for (const double estimate : {k, 3.2e8, 1e9}) {
    Stepper specimen{
        {spring(k),
         {"support_flexibility", "", {{"flexibility", chi}, {"stiffness_estimate", estimate}}}},
        kStep};
    double force = 0;
    for (int i = 1; i <= 1000; ++i) force = specimen.to(0.01).force[0];
    EXPECT_NEAR(force, k * 0.01 / (1 + k * chi), 1e-6 * force) << estimate;
  }
}

// Pushed in one direction: u = x + χ (K x + Q tanh(x/u_y)). The rest of the force is extrapolated
// with an error of K_i d²x < K_i a Δt², at 1 m/s² and 1 ms.
TEST(SupportFlexibility, IsInEquilibriumWithAYieldingSpecimen) {
  const double k = 4e6, strength = 1e6, yield = 2.8e-3, chi = 2e-9;
  Stepper specimen{{{"bouc_wen",
                     "",
                     {{"post_yield_stiffness", k},
                      {"characteristic_strength", strength},
                      {"yield_displacement", yield}}},
                    {"support_flexibility", "", {{"flexibility", chi}}}},
                   kStep};
  for (int i = 1; i <= 500; ++i) {
    const double t = kStep * i;
    const double force = specimen.to(0.5 * t * t).force[0];
    double x = 0.5 * t * t;
    for (int n = 0; n < 100; ++n) {
      const double z = std::tanh(x / yield);
      x -= (x + chi * (k * x + strength * z) - 0.5 * t * t) /
           (1 + chi * (k + strength / yield * (1 - z * z)));
    }
    const double expected = k * x + strength * std::tanh(x / yield);
    ASSERT_NEAR(force, expected, 2e-4 * strength + strength / yield * kStep * kStep) << t;
  }
}

TEST(SupportFlexibility, DoesNotChangeTheMeasuredDisplacement) {
  Stepper specimen{{spring(1e8), {"support_flexibility", "", {{"flexibility", 1e-8}}}}, kStep};
  for (int i = 0; i < 50; ++i) EXPECT_EQ(specimen.to(0.01).displacement[0], 0.01);
}

TEST(MountSlack, DeflectsUntilTheSpecimenIsSeated) {
  const double k = 1e8, slack = 2e-3, seat = 1e4;
  Stepper specimen{
      {spring(k),
       {"mount_slack", "", {{"slack", slack}, {"seating_force", seat}, {"stiffness_estimate", k}}}},
      kStep};

  // Within the slack g it is a series spring of stiffness F_seat/(g/2).
  EXPECT_NEAR(specimen.walk(0, 5e-4, 20).force[0], 5e-4 / (1 / k + 0.5 * slack / seat), 1e-3);
  EXPECT_NEAR(specimen.walk(5e-4, 0.01, 20).force[0], k * 0.009, 1e-3);
  EXPECT_NEAR(specimen.walk(0.01, -0.01, 20).force[0], -k * 0.009, 1e-3);
}

}  // namespace
}  // namespace rths::sim
