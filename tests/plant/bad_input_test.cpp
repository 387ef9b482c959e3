// SPDX-License-Identifier: Apache-2.0
//
// What a plant refuses, on a box of one element.
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "plant/drive.hpp"
#include "plant/plants.hpp"
#include "support/files.hpp"

namespace rths::plant {
namespace {

using rths::test::error_of;
using test::boxes;
using test::lead_rubber;

class BadPlant : public testing::Test {
 protected:
  [[nodiscard]] std::string check_error() const {
    return error_of([&] { check(structure_); });
  }
  [[nodiscard]] std::string basis_error(const BasisSettings& settings = {}) const {
    return error_of([&] { static_cast<void>(make_basis(structure_, bearings_, settings)); });
  }
  [[nodiscard]] std::string full_error(const PlantSettings& settings) const {
    return error_of(
        [&] { static_cast<void>(make_full(structure_, bearings_, test::petrolia(), settings)); });
  }

  Structure structure_ = assemble(boxes({}));
  BearingSet bearings_ = BearingSet::all_of(lead_rubber(), structure_.bearings.size());
};

TEST_F(BadPlant, IsNotThisOne) {
  EXPECT_EQ(check_error(), "");
  EXPECT_EQ(full_error({}), "");
}

TEST_F(BadPlant, HasAnUnsymmetricStiffness) {
  structure_.stiffness.coeffRef(4, 1) += 1e9;

  const std::string error = check_error();
  EXPECT_NE(error.find("row 5 column 2 is"), std::string::npos) << error;
  EXPECT_NE(error.find("but row 2 column 5 is"), std::string::npos) << error;
  EXPECT_NE(error.find("expected a symmetric matrix"), std::string::npos) << error;
}

// A process of its own, because its limit remains.
TEST_F(BadPlant, NeedsMoreMemoryThanThereIs) {
  const auto factorise_with_little = [] {
    const auto& large = test::large_plant();
    const SparseMatrix matrix =
        on_springs(large.structure, large.bearings, &BearingStiffness::initial);
    std::ifstream pages{"/proc/self/statm"};
    rlim_t used = 0;
    pages >> used;
    const rlim_t limit = used * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + 8'000'000;
    const rlimit little{limit, limit};
    setrlimit(RLIMIT_AS, &little);
    const std::string error = error_of([&] { Factor{matrix}; });
    std::fputs((error + '\n').c_str(), stderr);
    std::_Exit(0);
  };
  EXPECT_EXIT(factorise_with_little(), testing::ExitedWithCode(0),
              "the factor of a matrix of 5676 rows needs [0-9]+ MB of memory, but [0-9]+ MB are "
              "available");
}

TEST_F(BadPlant, HasADegreeOfFreedomWithoutMass) {
  structure_.mass[6] = 0;

  EXPECT_EQ(check_error(), "mass: row 7 is 0 kg, expected a positive number");
}

TEST_F(BadPlant, HasADegreeOfFreedomWithoutStiffness) {
  structure_.stiffness.coeffRef(2, 2) = -1;

  EXPECT_EQ(check_error(), "stiffness: the diagonal of row 3 is -1, expected a positive number");
}

TEST_F(BadPlant, HasAnotherNumberOfMasses) {
  structure_.mass.conservativeResize(23);

  EXPECT_EQ(check_error(), "stiffness is 24 × 24, but there are 23 masses, expected as many");
}

TEST_F(BadPlant, HasABearingWithoutADegreeOfFreedom) {
  structure_.nodes[1].dofs[2] = kNoDof;

  EXPECT_EQ(check_error(),
            "bearing 2 is at node 2, whose degree of freedom z is 0, expected 1 to 24");
}

TEST_F(BadPlant, HasNoBearings) {
  structure_.bearings.clear();

  EXPECT_EQ(check_error(), "the structure has no bearings, expected at least 1");
}

TEST_F(BadPlant, HasAFloorWithoutADegreeOfFreedom) {
  structure_.nodes[structure_.floors[0].node].dofs[0] = kNoDof;

  EXPECT_EQ(check_error(),
            "floor 'top' is at node 8, whose degree of freedom x is 0, expected 1 to 24");
}

TEST_F(BadPlant, HasAFloorAtNoNode) {
  structure_.floors[0].node = 8;

  EXPECT_EQ(check_error(), "floor 'top' is at node 9, but there are 8 nodes");
}

TEST_F(BadPlant, HasAnotherNumberOfBearingsThanItsStructure) {
  bearings_.kind_of.pop_back();

  EXPECT_EQ(basis_error(), "plant: 3 bearings are given, but the structure has 4");
  EXPECT_EQ(full_error({}), "plant: 3 bearings are given, but the structure has 4");
}

TEST_F(BadPlant, HasABearingOfNoKind) {
  bearings_.kind_of[2] = 1;

  EXPECT_EQ(basis_error(), "bearing 3 is of kind 2, but there are 1 kinds");
}

TEST_F(BadPlant, HasNoSuchTestedBearing) {
  EXPECT_EQ(basis_error({.tested_bearing = 4}), "basis: bearing 5 is tested, but there are 4");
  EXPECT_EQ(full_error({.tested_bearing = 4}), "plant: bearing 5 is tested, but there are 4");
}

TEST_F(BadPlant, HasSettingsOutOfRange) {
  EXPECT_EQ(full_error({.time_step = 0}),
            "plant: the time step is 0 s, expected a positive number");
  EXPECT_EQ(full_error({.alpha = -0.4}), "plant: alpha is -0.4, expected -1/3 to 0");
  EXPECT_EQ(full_error({.alpha = 0.1}), "plant: alpha is 0.1, expected -1/3 to 0");
  EXPECT_EQ(full_error({.damping_ratio = -0.1}),
            "plant: damping is -0.1 at 10 Hz, expected a ratio of 0 to 1 at a positive frequency");
  EXPECT_EQ(full_error({.damping_frequency = 0}),
            "plant: damping is 0.02 at 0 Hz, expected a ratio of 0 to 1 at a positive frequency");
}

TEST_F(BadPlant, HasABasisOfAnotherPlant) {
  const Structure longer = assemble(boxes({.elements = 2}));
  const auto six = BearingSet::all_of(lead_rubber(), longer.bearings.size());
  Basis basis;
  basis.bearings = MatrixXd::Zero(12, 4);
  basis.floors = MatrixXd::Zero(3, 4);

  EXPECT_EQ(error_of([&] {
              static_cast<void>(make_reduced(basis, six, test::petrolia(), longer.floors, {}));
            }),
            "plant: the basis has 4 bearings, expected 6");
  EXPECT_EQ(error_of([&] {
              static_cast<void>(make_reduced(basis, bearings_, test::petrolia(), {}, {}));
            }),
            "plant: the basis has 1 floors, expected 0");
}

// In exact arithmetic, the last six pivots of a free structure are zero.
TEST(Factor, RefusesAStructureWithoutItsBearings) {
  const Structure box = assemble(boxes({.elements = 3})), &plant = test::large_plant().structure;
  for (const auto* structure : {&box, &plant}) {
    const std::string error = error_of([&] { Factor{structure->stiffness}; });
    EXPECT_EQ(error.rfind("the matrix is not positive definite at row ", 0), 0U) << error;
    EXPECT_NE(error.find("expected a structure on its bearings without a part that moves freely"),
              std::string::npos);
  }
}

TEST(Factor, RefusesAPivotThatIsLeftByRounding) {
  SparseMatrix matrix(2, 2);
  matrix.coeffRef(0, 0) = 1;
  matrix.coeffRef(0, 1) = matrix.coeffRef(1, 0) = -1;
  matrix.coeffRef(1, 1) = 1 + 1e-14;

  EXPECT_NE(error_of([&] { Factor{matrix}; }).find("not positive definite at row"),
            std::string::npos);
  matrix.coeffRef(1, 1) = 1 + 1e-6;
  EXPECT_EQ(error_of([&] { Factor{matrix}; }), "");
}

TEST(Factor, RefusesAnIndefiniteMatrix) {
  SparseMatrix matrix(3, 3);
  matrix.setIdentity();
  matrix.coeffRef(1, 1) = -1;

  EXPECT_NE(error_of([&] { Factor{matrix}; }).find("not positive definite at row 2"),
            std::string::npos);
}

TEST(Factor, SolvesWithAPlantOnItsSoftestSprings) {
  const auto& [mesh, plant, bearings] = test::large_plant();
  std::vector<std::array<double, kDirections>> springs;
  for (const auto& stiffness : stiffness_of(bearings))
    springs.push_back(
        {1e-3 * stiffness.initial[0], 1e-3 * stiffness.initial[1], stiffness.initial[2]});
  const SparseMatrix matrix = plant.on_springs(springs);
  Factor factor{matrix};
  const VectorXd load = plant.inertia().col(0);

  VectorXd x;
  factor.solve(load, x);

  EXPECT_LT((matrix * x - load).norm(), 1e-9 * load.norm());
}

}  // namespace
}  // namespace rths::plant
