// SPDX-License-Identifier: Apache-2.0
// Compliant terms, coupled with the specimen's force in both directions, with every kind of force.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/sim/composition.hpp>

#include "sim/stepper.hpp"

namespace rths::sim {
namespace {

constexpr double kStiffnessEstimate = 4e8;    // the default of stiffness_estimate
constexpr double kTypicalFlexibility = 2e-9;  // typical

TermSettings typical(std::string_view name) {
  TermSettings term{std::string{name}, "", {}};
  for (const auto& parameter : term_kind(name).parameters)
    term.parameters.emplace_back(parameter.name, parameter.typical);
  return term;
}

struct Swing {
  double largest = 0;    // force [N]
  double travelled = 0;  // sum of the force's changes, which grows under chatter [N]
  double last = 0;       // change of the force in the last step [N]
};

// Two cycles, then rest.
Swing swing(const std::vector<TermSettings>& terms, double time_step) {
  constexpr double kAmplitude = 0.15, kRate = std::numbers::pi, kMoving = 4, kAll = 8;
  test_support::Stepper specimen{terms, time_step};
  Swing seen;
  double before = 0;
  for (double t = 0; t < kAll; t += time_step) {
    Quantities<double> q;
    const bool moves = t < kMoving;
    q.displacement[0] = moves ? kAmplitude * (1 - std::cos(kRate * t)) - kAmplitude / 3 : -0.05;
    q.velocity[0] = moves ? kAmplitude * kRate * std::sin(kRate * t) : 0;
    q.axial_load = 9.7e6;
    const double force = specimen.step(q).force[0];
    seen.last = force - before;
    // Skips the initial jump, which belongs to no cycle.
    if (t > 0.1) {
      seen.travelled += std::abs(seen.last);
      seen.largest = std::max(seen.largest, std::abs(force));
      if (!std::isfinite(force)) seen.largest = HUGE_VAL;
    }
    before = force;
  }
  return seen;
}

// Specimens with velocity-dependent forces: at 0.1 ms, c/Δt would be a stiffness of 2e9 N/m or
// more.
std::vector<std::vector<TermSettings>> specimens() {
  return {{test_support::spring(4e6), typical("viscous_damping")},
          {test_support::spring(4e6), {"viscous_damping", "", {{"damping", 5e6}}}},
          {test_support::spring(4e6), typical("piecewise_damping")},
          {typical("bouc_wen"), typical("rate_dep_strength")},
          {test_support::spring(4e6), typical("gap_contact")}};
}

void expect_as_steady_as_rigid(const std::vector<TermSettings>& specimen,
                               const std::vector<TermSettings>& mount) {
  auto both = specimen;
  both.insert(both.end(), mount.begin(), mount.end());
  for (const double time_step : {1e-4, 1e-3, 1e-2}) {
    const Swing rigid = swing(specimen, time_step), yielding = swing(both, time_step);
    const std::string terms = fmt::format("{} and {} with {}, {} s", specimen[0].kind,
                                          specimen[1].kind, mount[0].kind, time_step);
    EXPECT_LT(yielding.largest, 1.1 * rigid.largest) << terms;
    // A dead zone removes the damper's force and restores it.
    EXPECT_LT(yielding.travelled, 2 * rigid.travelled) << terms;
    EXPECT_LT(std::abs(yielding.last), 1e-9 * rigid.largest) << terms;
  }
}

TEST(Compliance, IsStableWithVelocityDependentForcesAtAnyStep) {
  for (const auto& kind : catalogue())
    if (kind.stage == Stage::Motion || kind.name == "load_compliance")
      for (const auto& specimen : specimens())
        expect_as_steady_as_rigid(specimen, {typical(kind.name)});
}

TEST(Compliance, IsStableInSeriesWithOthers) {
  for (const auto& specimen : specimens())
    expect_as_steady_as_rigid(specimen, {typical("load_compliance"), typical("support_flexibility"),
                                         typical("mount_slack")});
}

// An error shrinks by |g| + √(g² + |g|) per step where the tangent is above the estimate:
// g = χ(K − K_t)/(1 + χK), 1 at g = −1/3.
TEST(Compliance, IsStableUpToTheDocumentedStiffness) {
  const double limit = 4 * kStiffnessEstimate / 3 + 1 / (3 * kTypicalFlexibility);
  for (const double fraction : {0.95, 1.05}) {
    test_support::Stepper specimen{
        {test_support::spring(fraction * limit),
         {"support_flexibility", "", {{"flexibility", kTypicalFlexibility}}}},
        1e-3};
    double force = 0;
    for (int i = 0; i < 1000; ++i) force = specimen.to(0.01).force[0];
    const double expected = 0.01 / (kTypicalFlexibility + 1 / (fraction * limit));
    if (fraction < 1)
      EXPECT_NEAR(force, expected, 1e-6 * expected);
    else
      EXPECT_GT(std::abs(force), 10 * expected);
  }
}

}  // namespace
}  // namespace rths::sim
