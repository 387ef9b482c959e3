// SPDX-License-Identifier: Apache-2.0
//
// The plant on unyielded bearings here and in OpenSees, from the same mesh.
#include <fstream>

#include <gtest/gtest.h>

#include <rths/plant/modes.hpp>

#include "benchmarks/solver/src/mesh_files.hpp"
#include "plant/plants.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/with_opensees.hpp"

namespace rths::plant {
namespace {

using test::large_plant;
using Springs = std::vector<std::array<double, kDirections>>;

constexpr Index kModes = 20;
constexpr double kTimeout = 100;  // of OpenSees [s]

std::vector<double> numbers_of(const std::filesystem::path& file) {
  std::vector<double> numbers;
  std::ifstream in{file};
  for (double number = 0; in >> number;) numbers.push_back(number);
  return numbers;
}

using PlantInOpenSees = rths::test::WithOpenSees<>;

TEST_F(PlantInOpenSees, HasTheSameFrequencies) {
  const rths::test::TemporaryFolder folder;
  const auto& [mesh, plant, bearings] = large_plant();
  Springs springs;
  for (const auto& stiffness : stiffness_of(bearings)) springs.push_back(stiffness.initial);
  bench::write_mesh(folder.path(), mesh, plant, springs);
  const auto script = rths::test::source_tree() / "benchmarks/solver/solids/solid_plant.py";
  rths::test::Running running{
      {python_, script.string(), folder.path().string(), "frequencies", std::to_string(kModes)}};
  Factor factor{plant.on_springs(springs)};

  const StructureModes ours = lowest_modes(factor, plant.mass, kModes);
  const auto finished = running.wait(kTimeout);

  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const auto theirs = numbers_of(folder.path() / "frequencies.csv");
  ASSERT_EQ(std::ssize(theirs), kModes);
  double largest = 0;
  for (Index i = 0; i < kModes; ++i) {
    const double expected = theirs[static_cast<std::size_t>(i)];
    largest = std::max(largest, std::abs(ours.frequencies[i] / expected - 1));
    EXPECT_NEAR(ours.frequencies[i], expected, 1e-4 * expected) << "mode " << i + 1;
  }
  RecordProperty("largest_difference_percent", std::to_string(100 * largest));
}

}  // namespace
}  // namespace rths::plant
