// SPDX-License-Identifier: Apache-2.0
//
// Models of OpenSees as files of a plant: they have the frequencies of OpenSees itself.
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/plant/modes.hpp>
#include <rths/plant/structure_files.hpp>

#include "benchmarks/solver/src/mesh_files.hpp"
#include "plant/plants.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/with_opensees.hpp"

namespace rths::plant {
namespace {

constexpr Index kCompared = 12;
constexpr double kPatience = 200;  // of OpenSees [s]

class ExportFromOpenSees : public rths::test::WithOpenSees<> {
 protected:
  [[nodiscard]] rths::test::Finished export_model(const std::string& model) const {
    const auto tree = rths::test::source_tree();
    rths::test::Running running{{python_, (tree / "tests/opensees/export_plants.py").string(),
                                 tree.string(), folder_.path().string(), model,
                                 std::to_string(kCompared)}};
    return running.wait(kPatience);
  }
  [[nodiscard]] Structure exported() const {
    return read_structure(StructureFiles::in(folder_.path() / "plant"));
  }
  // Both solve for eigenvalues to about 1e-9.
  void expect_frequencies(const Structure& structure,
                          const std::vector<std::array<double, kDirections>>& springs) const {
    Factor factor{structure.on_springs(springs)};
    const StructureModes modes = lowest_modes(factor, structure.mass, kCompared);
    std::ifstream file{folder_.path() / "frequencies.csv"};
    double largest = 0;
    for (Index i = 0; i < kCompared; ++i) {
      double expected = 0;
      ASSERT_TRUE(file >> expected) << i;
      largest = std::max(largest, std::abs(modes.frequencies[i] / expected - 1));
    }
    EXPECT_LT(largest, 1e-6);
    ::testing::Test::RecordProperty("largest_difference", fmt::format("{:.2g}", largest));
  }

  rths::test::TemporaryFolder folder_;
};

TEST_F(ExportFromOpenSees, KeepsTheFrequenciesOfAPlantOfBricks) {
  const auto& [mesh, plant, bearings] = test::large_plant();
  std::vector<std::array<double, kDirections>> springs;
  for (const auto& stiffness : stiffness_of(bearings)) springs.push_back(stiffness.initial);
  bench::write_mesh(folder_.path(), mesh, plant, springs);

  const auto finished = export_model("bricks");

  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const Structure structure = exported();
  EXPECT_EQ(structure.dofs(), plant.dofs());
  EXPECT_EQ(structure.bearings, plant.bearings);
  expect_frequencies(structure, springs);
  // Element by element the same solids as here, in the same order.
  EXPECT_LT((structure.stiffness - plant.stiffness).norm(), 1e-6 * plant.stiffness.norm());
}

TEST_F(ExportFromOpenSees, CondensesRotationsAndARigidDiaphragmOfAFrame) {
  for (const char* units : {"frame", "inches"}) {
    const auto finished = export_model(units);

    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    const Structure structure = exported();
    EXPECT_EQ(structure.dofs(), 45);  // 3 of 12 nodes, 1 of 6, and 3 of the diaphragm
    EXPECT_NEAR(structure.mass_along(0), 414e3, 1e-6 * 414e3);
    EXPECT_EQ(structure.floors.at(0).name, "roof");
    expect_frequencies(structure, {structure.bearings.size(), {2e7, 2e7, 8e9}});
  }
}

TEST_F(ExportFromOpenSees, NamesWhatItCannotExport) {
  struct Case {
    const char *model, *message;
  };
  for (const Case& one :
       {Case{"diaphragm",
             "floor 'lower': node 11 follows node 99 along x, expected a node that "
             "moves freely"},
        Case{"held", "a support holds the structure along x at degree of freedom 1 of node 1"},
        Case{"coupled",
             "the mass couples degree of freedom 2 of node 99 and degree of freedom 6"}}) {
    const auto finished = export_model(one.model);

    EXPECT_NE(finished.exit_code, 0) << one.model;
    EXPECT_NE(finished.err.find(one.message), std::string::npos) << finished.err;
  }
}

}  // namespace
}  // namespace rths::plant
