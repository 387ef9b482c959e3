// SPDX-License-Identifier: Apache-2.0
//
// The energy balance of a run. With alpha = 0, only the bearings' forces, which are those of the
// predicted motion, make an error.
#include <gtest/gtest.h>

#include "plant/drive.hpp"
#include "plant/plants.hpp"

namespace rths::plant {
namespace {

using test::large_basis;
using test::large_plant;
using test::lead_rubber;

using test::kTimeStep;

PlantSettings counting() {
  PlantSettings settings;
  settings.time_step = kTimeStep;
  settings.alpha = 0;
  settings.counts_energy = true;
  return settings;
}

EnergyBalance after(LargePlantAnalysis& plant, double duration) {
  static_cast<void>(test::drive(plant, lead_rubber(), kTimeStep, duration));
  return plant.energy();
}

// Of the input. Measured: 1.2e-5 after the first 1.5 s, 4e-7 after 6 s.
constexpr double kBound = 1e-4;

void expect_balance(const EnergyBalance& energy) {
  EXPECT_GT(energy.input, 0);
  EXPECT_GT(energy.kinetic, 0);
  EXPECT_GT(energy.strain, 0);
  EXPECT_GT(energy.damped, 0);
  EXPECT_GT(energy.absorbed, 0);
  EXPECT_LE(std::abs(energy.error()), kBound * energy.input);
}

TEST(Energy, OfTheReducedPlantIsBalanced) {
  const auto& [mesh, structure, bearings] = large_plant();
  const auto plant =
      make_reduced(large_basis(), bearings, test::petrolia(), structure.floors, counting());

  const EnergyBalance energy = after(*plant, 6);

  expect_balance(energy);
  RecordProperty("error_percent", std::to_string(100 * energy.error() / energy.input));
}

TEST(Energy, IsTheSameInTheFullPlant) {
  constexpr double kShort = 1.5;  // [s]
  const auto& [mesh, structure, bearings] = large_plant();
  const auto reduced =
      make_reduced(large_basis(), bearings, test::petrolia(), structure.floors, counting());
  const auto full = make_full(structure, bearings, test::petrolia(), counting());

  const EnergyBalance expected = after(*full, kShort), found = after(*reduced, kShort);

  expect_balance(expected);
  for (const auto member : {&EnergyBalance::kinetic, &EnergyBalance::strain, &EnergyBalance::damped,
                            &EnergyBalance::absorbed, &EnergyBalance::input})
    EXPECT_NEAR(found.*member, expected.*member, 1e-2 * expected.input);
}

TEST(Energy, IsNotCountedUnlessAskedFor) {
  const auto& [mesh, structure, bearings] = large_plant();
  PlantSettings settings = counting();
  settings.counts_energy = false;
  const auto plant =
      make_reduced(large_basis(), bearings, test::petrolia(), structure.floors, settings);

  EXPECT_EQ(after(*plant, 0.1).input, 0);
}

}  // namespace
}  // namespace rths::plant
