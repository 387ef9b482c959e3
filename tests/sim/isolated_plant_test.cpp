// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/isolated_plant.hpp>

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <rths/maths/decompositions.hpp>

#include "support/files.hpp"
#include "support/lead_rubber.hpp"

namespace rths::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd frequencies(const MatrixXd& K, const MatrixXd& M) {
  return maths::generalized_modes(K, M).values.cwiseMax(0).cwiseSqrt() / (2 * std::numbers::pi);
}

MatrixXd with_bearings(const PlantMatrices& plant, double stiffness) {
  MatrixXd K = plant.K;
  K(0, 0) += plant.bearings * stiffness;
  K(1, 1) += plant.bearings * stiffness;
  return K;
}

TEST(IsolatedPlant, CanMoveAsARigidBodyWithoutItsBearings) {
  const PlantMatrices plant = assemble(example_plant());

  EXPECT_LT((plant.K * plant.iota).norm(), 1e-6 * plant.K.norm());
  EXPECT_LT((plant.C * plant.iota).norm(), 1e-6 * plant.C.norm());
}

TEST(IsolatedPlant, IsSymmetric) {
  const PlantMatrices plant = assemble(example_plant());

  EXPECT_LT((plant.K - plant.K.transpose()).norm(), 1e-12 * plant.K.norm());
  EXPECT_LT((plant.C - plant.C.transpose()).norm(), 1e-12 * plant.C.norm());
}

TEST(IsolatedPlant, HasTheGivenFrequenciesOnAFixedBase) {
  const PlantMatrices fixed = assemble(example_plant()).fixed_base();

  const VectorXd f = frequencies(fixed.K, fixed.M);

  const double expected[] = {4.4, 4.6, 5.9, 6.3, 7.6, 7.6};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(f[i], expected[i], 1e-6);
}

TEST(IsolatedPlant, HasItsDampingRatioInEveryFixedBaseMode) {
  const PlantMatrices fixed = assemble(example_plant()).fixed_base();
  const maths::Modes modes = maths::generalized_modes(fixed.K, fixed.M);

  const MatrixXd modal = modes.vectors.transpose() * fixed.C * modes.vectors;

  for (int i = 0; i < fixed.dofs(); ++i)
    EXPECT_NEAR(modal(i, i) / (2 * std::sqrt(modes.values[i])), 0.04, 1e-9);
}

TEST(IsolatedPlant, HasTheIsolationFrequenciesOfItsDesign) {
  const PlantMatrices plant = assemble(example_plant());

  EXPECT_NEAR(frequencies(with_bearings(plant, test::kInitialStiffness), plant.M)[0], 2.8, 0.05);
  EXPECT_NEAR(1 / frequencies(with_bearings(plant, test::kPostYieldStiffness), plant.M)[0], 3.0,
              0.1);
}

TEST(IsolatedPlant, RefusesAStickWithoutAFloorAtTheSpectrumElevation) {
  IsolatedPlant plant = example_plant();
  plant.spectrum_elevation = 33;

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(assemble(plant));
            }).find("'containment' has no mass at the spectrum elevation"),
            std::string::npos);
}

TEST(IsolatedPlant, RefusesUnphysicalParameters) {
  IsolatedPlant massless = example_plant();
  massless.basemat_mass = 0;
  IsolatedPlant uneven = example_plant();
  uneven.sticks[0].elevations.pop_back();

  EXPECT_NE(test::error_of([&] { static_cast<void>(assemble(massless)); }), "");
  EXPECT_NE(test::error_of([&] { static_cast<void>(assemble(uneven)); }), "");
}

}  // namespace
}  // namespace rths::sim
