// SPDX-License-Identifier: Apache-2.0
//
// The mesh of the plant, its elements and its frequencies.
#include <rths/plant/ant.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/plant/modes.hpp>

#include "plant/plants.hpp"
#include "support/files.hpp"

namespace rths::plant {
namespace {

using rths::test::error_of;
using test::boxes;
using test::large_plant;

TEST(AntMesh, HasTheSizeOfItsDesign) {
  const Structure& plant = large_plant().structure;

  EXPECT_EQ(plant.dofs(), 5'676);
  EXPECT_EQ(plant.bearings.size(), 486U);
  EXPECT_NO_THROW(check(plant));
}

TEST(AntMesh, HasTheMassOfItsDesignInEachDirection) {
  for (std::size_t direction = 0; direction < kDirections; ++direction)
    EXPECT_NEAR(large_plant().structure.mass_along(direction), 480e6, 480e6 * 1e-12);
}

TEST(AntMesh, HasAFloorOfEachBuildingAtTheSameElevation) {
  const Structure& plant = large_plant().structure;

  ASSERT_EQ(plant.floors.size(), 3U);
  for (const auto& floor : plant.floors)
    EXPECT_NEAR(plant.nodes[floor.node].place[2], 47.5, 1e-9) << floor.name;
  EXPECT_EQ(plant.floors[0].name, "containment_47.5");
  EXPECT_EQ(plant.floors[1].name, "internal_47.5");
  EXPECT_EQ(plant.floors[2].name, "auxiliary_47.5");
}

TEST(AntMesh, HasTheFrequenciesOfItsBuildingsOnAFixedBase) {
  const AntDesign design = ant_with(5'676);
  for (const PlantPart part : {PlantPart::Containment, PlantPart::Internal, PlantPart::Auxiliary}) {
    const Structure building = on_fixed_base(large_plant().mesh, part);
    Factor factor{building.stiffness};

    const double found = lowest_modes(factor, building.mass, 1).frequencies[0];

    EXPECT_NEAR(found, design.frequencies[static_cast<std::size_t>(part)], 1e-6 * found);
  }
}

TEST(AntDesign, IsTheOneOfTheNearestSize) {
  EXPECT_EQ(ant_with(0).levels, 2);
  EXPECT_EQ(ant_with(10'000).levels, 2);
  EXPECT_EQ(ant_with(10'020).levels, 9);
  EXPECT_EQ(ant_with(50'000).plan, 2);
  EXPECT_EQ(ant_with(50'000).mat_layers, 1);
  EXPECT_EQ(ant_with(1'000'000).mat_layers, 2);
}

TEST(AntDesign, NeedsAnElementInEachDirection) {
  AntDesign design;
  design.mat_layers = 0;

  EXPECT_EQ(error_of([&] { static_cast<void>(mesh_of(design)); }),
            "plant: 1 elements between bearings, 0 through the mat and 2 up to the floors, "
            "expected at least 1 of each");
}

/// Motion of all nodes, from their places.
template <class Motion>
VectorXd moved(const Structure& structure, const Motion& motion) {
  VectorXd u(structure.dofs());
  for (const auto& node : structure.nodes) {
    const Eigen::Vector3d at = motion(Eigen::Vector3d{node.place[0], node.place[1], node.place[2]});
    for (std::size_t k = 0; k < kDirections; ++k) u[node.dofs[k]] = at[static_cast<Index>(k)];
  }
  return u;
}

TEST(Solid, ResistsNoRigidBodyMotion) {
  const Structure box = assemble(boxes({}));
  const double scale = box.stiffness.diagonal().maxCoeff();
  for (Index axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);

    const VectorXd shifted =
        box.stiffness * moved(box, [&](const Eigen::Vector3d&) { return unit; });
    const VectorXd turned =
        box.stiffness * moved(box, [&](const Eigen::Vector3d& at) { return unit.cross(at); });

    EXPECT_LT(shifted.cwiseAbs().maxCoeff(), 1e-13 * scale) << axis;
    EXPECT_LT(turned.cwiseAbs().maxCoeff(), 1e-13 * scale * 5) << axis;  // the box is 5 m wide
  }
}

TEST(Solid, HasTheStiffnessOfABarWithoutLateralContraction) {
  const double modulus = 1e9;
  const Structure box = assemble(boxes({.modulus = modulus, .poisson_ratio = 0}));
  const double extension = 1e-3;

  const VectorXd force = box.stiffness * moved(box, [&](const Eigen::Vector3d& at) {
                           return Eigen::Vector3d{extension * at[0] / test::kBoxLong, 0, 0};
                         });

  const double expected =
      modulus * test::kBoxLat * test::kBoxHeight / test::kBoxLong * extension;  // EA/L
  for (const auto& node : box.nodes) {
    const double along = (node.place[0] > 0 ? 1 : -1) * expected / 4;
    EXPECT_NEAR(force[node.dofs[0]], along, 1e-12 * expected);
    EXPECT_NEAR(force[node.dofs[1]], 0, 1e-12 * expected);
    EXPECT_NEAR(force[node.dofs[2]], 0, 1e-12 * expected);
  }
}

TEST(Solid, SharesItsMassEvenly) {
  const Structure box = assemble(boxes({.density = 2000}));

  const double mass = 2000 * test::kBoxLong * test::kBoxLat * test::kBoxHeight;
  EXPECT_NEAR((box.mass.array() - mass / 8).abs().maxCoeff(), 0, 1e-12 * mass);
}

// The mat is flexible: a bearing below a wall carries more than one at the edge.
TEST(Gravity, IsCarriedByBearingsOfUnequalLoad) {
  const auto& [mesh, plant, bearings] = large_plant();
  std::vector<std::array<double, kDirections>> springs;
  for (const auto& stiffness : stiffness_of(bearings)) springs.push_back(stiffness.initial);
  Factor factor{plant.on_springs(springs)};

  const VectorXd weights = static_weights(plant, bearings, factor);

  const double weight = plant.mass_along(2) * kStandardGravity;
  EXPECT_NEAR(weights.sum(), weight, 1e-9 * weight);
  EXPECT_GT(weights.minCoeff(), 0.8e6);
  EXPECT_LT(weights.maxCoeff(), 19e6);
  EXPECT_GT(weights.maxCoeff(), 5 * weights.minCoeff());
}

}  // namespace
}  // namespace rths::plant
