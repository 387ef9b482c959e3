// SPDX-License-Identifier: Apache-2.0
//
// A rigid mat whose constraint is eliminated, and plants on one and five bearings that stand for
// 486.
#include <numbers>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include <rths/core/constants.hpp>
#include <rths/plant/large_plant.hpp>

#include "plant/drive.hpp"
#include "plant/plants.hpp"
#include "support/files.hpp"

namespace rths::plant {
namespace {

using test::large_plant;
using test::lead_rubber;

constexpr double kPlantWeight = 480e6 * kStandardGravity;  // [N]

Structure few_bearings(std::size_t bearings) {
  return assemble_on_rigid_mat(large_plant().mesh, bearings);
}

BearingSet set_of(std::size_t bearings) {
  BearingSet set = BearingSet::all_of(lead_rubber(), bearings);
  set.stands_for = 486. / static_cast<double>(bearings);
  return set;
}

/// A rigid-body motion: translation and rotation about the origin.
struct RigidMotion {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d at(const MeshNode& node) const {
    return shift + turn.cross(Eigen::Vector3d::Map(node.place.data()));
  }
};
std::vector<RigidMotion> all_rigid_motions() {
  std::vector<RigidMotion> motions(6);
  for (Index k = 0; k < 3; ++k) {
    motions[static_cast<std::size_t>(k)].shift[k] = 1;
    motions[static_cast<std::size_t>(3 + k)].turn[k] = 1;
  }
  return motions;
}

// u of a structure in which each node has its own degrees of freedom.
VectorXd moved_nodes(const Structure& structure, const RigidMotion& motion) {
  VectorXd u(structure.dofs());
  for (const auto& node : structure.nodes)
    for (std::size_t k = 0; k < kDirections; ++k)
      u[node.dofs[k]] = motion.at(node)[static_cast<Index>(k)];
  return u;
}

// q of the structure on a rigid mat: the mat's coordinates are those that move its bearings so.
VectorXd moved_on_mat(const Structure& structure, const RigidMotion& motion) {
  VectorXd q = VectorXd::Zero(structure.dofs()), at_bearings(structure.bearing_map.rows());
  for (const auto& node : structure.nodes)
    for (std::size_t k = 0; k < kDirections; ++k)
      if (node.dofs[k] >= 6) q[node.dofs[k]] = motion.at(node)[static_cast<Index>(k)];
  for (std::size_t i = 0; i < structure.bearings.size(); ++i)
    at_bearings.segment<3>(static_cast<Index>(3 * i)) =
        motion.at(structure.nodes[structure.bearings[i]]);
  const MatrixXd B = MatrixXd{structure.bearing_map}.leftCols(6);
  q.head(6) = B.householderQr().solve(at_bearings);
  return q;
}

TEST(RigidMat, ResistsNoRigidBodyMotion) {
  const Structure plant = few_bearings(5);
  EXPECT_EQ(plant.dofs(), 5'676 - 3 * 27 * 18 * 2 + 6);
  EXPECT_NO_THROW(check(plant));
  for (const auto& motion : all_rigid_motions()) {
    const VectorXd q = moved_on_mat(plant, motion);

    const VectorXd force = plant.stiffness * q;

    // Entries of the mat's rotation are stiffness times the squares of up to 100 m.
    const double scale = plant.stiffness.diagonal().maxCoeff() * q.cwiseAbs().maxCoeff();
    EXPECT_LT(force.cwiseAbs().maxCoeff(), 1e-13 * scale);
  }
}

TEST(RigidMat, KeepsTheInertiaOfEachRigidBodyMotion) {
  const Structure plant = few_bearings(5);
  const Structure& flexible = large_plant().structure;
  const auto motions = all_rigid_motions();
  for (const auto& one : motions)
    for (const auto& other : motions) {
      const VectorXd u = moved_nodes(flexible, one), v = moved_nodes(flexible, other);
      const VectorXd q = moved_on_mat(plant, one), p = moved_on_mat(plant, other);
      const double scale = u.cwiseAbs().maxCoeff() * v.cwiseAbs().maxCoeff() * flexible.mass.sum();

      EXPECT_NEAR(q.dot(plant.mass.cwiseProduct(p)), u.dot(flexible.mass.cwiseProduct(v)),
                  1e-12 * scale);
    }
  for (std::size_t k = 0; k < kDirections; ++k)
    EXPECT_NEAR(plant.mass_along(k), 480e6, 480e6 * 1e-12);
}

TEST(RigidMat, IsRefusedWithoutANodeOrABearing) {
  const Structure box = assemble(test::boxes({}));
  const auto error = [&](const RigidMat& mat) {
    return rths::test::error_of([&] { static_cast<void>(on_rigid_mat(box, mat)); });
  };

  EXPECT_EQ(error({{}, {{0, 0, 0}}}),
            "rigid mat: 0 nodes on 1 bearings, expected at least 1 of each");
  EXPECT_EQ(error({{0, 1}, {}}), "rigid mat: 2 nodes on 0 bearings, expected at least 1 of each");
  EXPECT_EQ(error({{0, 8}, {{0, 0, 0}}}), "rigid mat: node 9 is none that moves");
}

TEST(FewBearings, HaveTheSecondMomentsOfAll) {
  for (std::size_t k = 0; k < 2; ++k) {
    std::array<double, 2> moments{};
    for (std::size_t i = 0; const std::size_t bearings : {std::size_t{5}, kAntBearings}) {
      for (const auto& place : ant_bearing_places(bearings)) moments[i] += place[k] * place[k];
      moments[i++] *= 486. / static_cast<double>(bearings);
    }
    EXPECT_NEAR(moments[0], moments[1], 1e-12 * moments[1]);
  }
  EXPECT_EQ(rths::test::error_of([] { static_cast<void>(ant_bearing_places(7)); }),
            "plant: 7 bearings, expected 1, 5, 486");
}

// Of a plant whose buildings hardly deform: a mass on 486 springs.
TEST(FewBearings, HaveTheFrequencyOfAMassOnAllSprings) {
  AntDesign design = ant_with(5'676);
  constexpr double kStiff = 100;  // times the frequencies of the buildings
  for (double& frequency : design.frequencies) frequency *= kStiff;
  const Structure plant = assemble_on_rigid_mat(mesh_of(design), 1);
  const BearingSet bearings = set_of(1);
  Factor factor{on_springs(plant, bearings, &BearingStiffness::initial)};

  const StructureModes modes = lowest_modes(factor, plant.mass, 3);

  const auto expected = [](double stiffness) {
    return std::sqrt(486 * stiffness / 480e6) / (2 * std::numbers::pi);
  };
  const double stiffness = stiffness_of(bearings)[0].initial[0];
  // Dunkerley: a building of the share s of the mass lowers f² by s (f/f_b)², below 4e-5 along and
  // (9.6 Hz against some 600 Hz and more) 3e-4 up.
  EXPECT_NEAR(modes.frequencies[0], expected(stiffness), 5e-5 * expected(stiffness));
  EXPECT_NEAR(modes.frequencies[1], expected(stiffness), 5e-5 * expected(stiffness));
  EXPECT_NEAR(modes.frequencies[2], expected(8e9), 3e-4 * expected(8e9));
}

TEST(FewBearings, HaveTheFrequenciesOf486BelowAStiffMat) {
  AntDesign design = ant_with(5'676);
  design.basemat_modulus *= 1e6;  // the largest difference falls with it: 1e-3 for 1e5
  const AntMesh stiff = mesh_of(design);
  const auto frequencies = [](const Structure& plant, const BearingSet& bearings) {
    Factor factor{on_springs(plant, bearings, &BearingStiffness::post_yield)};
    return VectorXd{lowest_modes(factor, plant.mass, 12).frequencies};
  };

  const VectorXd five = frequencies(assemble_on_rigid_mat(stiff, 5), set_of(5)),
                 all = frequencies(assemble(stiff), set_of(486));

  for (Index i = 0; i < five.size(); ++i) EXPECT_NEAR(five[i], all[i], 2e-4 * all[i]) << i;
}

Basis basis_of(std::size_t bearings) {
  return make_basis(few_bearings(bearings), set_of(bearings), {.tested_bearing = 0});
}

TEST(FewBearings, CarryTheWeightOfThePlant) {
  for (const std::size_t count : {1U, 5U}) {
    const Basis basis = basis_of(count);

    ASSERT_EQ(basis.weights.size(), static_cast<Index>(count));
    EXPECT_NEAR(basis.weights.sum() * 486. / static_cast<double>(count), kPlantWeight,
                1e-9 * kPlantWeight);
  }
}

struct CountedRun {
  MatrixXd loads;  ///< vertical targets of the tested bearing; a row by step [N]
  EnergyBalance energy;
};

CountedRun run(std::size_t bearings, sim::GroundMotion motion) {
  PlantSettings settings;
  settings.time_step = test::kTimeStep;
  settings.alpha = 0;
  settings.counts_energy = true;
  const auto plant = make_reduced(basis_of(bearings), set_of(bearings), motion,
                                  large_plant().structure.floors, settings);
  const test::Response response = test::drive(*plant, lead_rubber(), test::kTimeStep, 6);
  return {response.loads, plant->energy()};
}

TEST(FewBearings, FeelOverturningUnlessThereIsOne) {
  sim::GroundMotion level = test::petrolia();
  level.vert_acceleration.clear();

  const CountedRun one = run(1, level), five = run(5, level);

  const double share = kPlantWeight / 486;
  EXPECT_LT(one.loads.cwiseAbs().maxCoeff(), 1e-6 * share);
  EXPECT_GT(five.loads.maxCoeff(), 0.05 * share);
  EXPECT_LT(five.loads.minCoeff(), -0.05 * share);
}

TEST(FewBearings, KeepTheirBalanceOfEnergy) {
  for (const std::size_t count : {1U, 5U}) {
    const EnergyBalance energy = run(count, test::petrolia()).energy;

    EXPECT_GT(energy.absorbed, 0);
    EXPECT_LE(std::abs(energy.error()), 1e-3 * energy.input);
    RecordProperty("error_percent_" + std::to_string(count),
                   std::to_string(100 * energy.error() / energy.input));
  }
}

TEST(FewBearings, RespondAsWithAllCoordinates) {
  const Structure structure = few_bearings(5);
  const BearingSet bearings = set_of(5);
  PlantSettings settings;
  settings.time_step = test::kTimeStep;
  settings.tested_bearing = 2;
  const auto reduced = make_reduced(make_basis(structure, bearings, {.tested_bearing = 2}),
                                    bearings, test::petrolia(), structure.floors, settings);
  const auto full = make_full(structure, bearings, test::petrolia(), settings);

  const auto found = test::drive(*reduced, lead_rubber(), test::kTimeStep, 4),
             expected = test::drive(*full, lead_rubber(), test::kTimeStep, 4);

  EXPECT_LE(test::difference(found.tested, expected.tested), 0.05);
  EXPECT_LE(test::spectral_difference(found, expected), 0.5);
  RecordProperty("tested_percent", std::to_string(test::difference(found.tested, expected.tested)));
}

TEST(FewBearings, OverturnInAModelUnlessThereIsOne) {
  for (const std::size_t count : kAntModels) {
    if (count == kAntBearings) continue;  // see LargePlantModel
    AntDesign design = ant_with(5'676);
    design.bearings = count;
    const LargePlant plant{describe(design, lead_rubber()), std::nullopt};

    EXPECT_EQ(plant.overturns(), count > 1);
    EXPECT_NE(
        plant.summary().find("on 486 bearings, modelled by " + std::to_string(count) + ", that"),
        std::string::npos)
        << plant.summary();
  }
}

}  // namespace
}  // namespace rths::plant
