// SPDX-License-Identifier: Apache-2.0
// Integration error of the Bouc-Wen laws, against the same path in many small steps.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "sim/stepper.hpp"

namespace rths::sim {
namespace {

constexpr double kUnitYield = 1e-3;

TermSettings with_unit_strength(const std::string& kind, test_support::Values values) {
  values.emplace_back("characteristic_strength", 1);
  values.emplace_back("yield_displacement", kUnitYield);
  return {kind, "", values};
}

// Largest error over random steps in the plane, each about `yields` yield displacements long.
double integration_error(const TermSettings& term, double yields) {
  test_support::Stepper coarse{{term}, 1e-3}, fine{{term}, 1e-3};
  std::mt19937 random{1};
  std::normal_distribution<double> normal;
  double x = 0, y = 0, worst = 0;
  constexpr int kFineSteps = 100;
  for (int i = 0; i < 200; ++i) {
    const double dx = yields * kUnitYield * normal(random),
                 dy = yields * kUnitYield * normal(random);
    Quantities<double> exact;
    for (int j = 1; j <= kFineSteps; ++j)
      exact = fine.to(x + dx * j / kFineSteps, y + dy * j / kFineSteps);
    x += dx, y += dy;
    const auto seen = coarse.to(x, y);
    worst =
        std::max(worst, std::hypot(seen.force[0] - exact.force[0], seen.force[1] - exact.force[1]));
  }
  return worst;
}

TEST(BoucWenSteps, AreAsExactAsDocumentedInThePlane) {
  for (const double yields : {0.2, 1.0, 5.0, 30.0}) {
    EXPECT_LT(integration_error(with_unit_strength("bouc_wen", {}), yields), 2e-4) << yields;
    for (const double eta : {1.0, 5.0, 10.0, 20.0})
      EXPECT_LT(
          integration_error(with_unit_strength("bouc_wen", {{"eta", eta}, {"beta", 0.9}}), yields),
          1e-3)
          << eta;
    EXPECT_LT(integration_error(with_unit_strength("bouc_wen", {{"coupling", 0}}), yields), 1e-3)
        << yields;
    EXPECT_LT(integration_error(
                  with_unit_strength("bouc_wen_slip", {{"slip_length", 4 * kUnitYield}}), yields),
              3e-3)
        << yields;
  }
}

TEST(BoucWenSteps, ReturnNaNForADisplacementOfNaN) {
  for (const auto* kind : {"bouc_wen", "bouc_wen_nagarajaiah", "bouc_wen_slip"}) {
    test_support::Stepper bearing{{with_unit_strength(kind, {})}, 1e-3};
    bearing.to(0.01);
    EXPECT_TRUE(std::isnan(bearing.to(std::numeric_limits<double>::quiet_NaN()).force[0])) << kind;
  }
}

}  // namespace
}  // namespace rths::sim
