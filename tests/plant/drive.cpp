// SPDX-License-Identifier: Apache-2.0
#include "plant/drive.hpp"

#include <algorithm>

#include "support/files.hpp"

namespace rths::plant::test {

sim::GroundMotion petrolia(double scale) {
  return sim::read_motion(
      rths::test::source_tree() / "examples/records/petrolia_1992_riodell_freefield.csv", {2, 1, 3},
      scale);
}

double spectral_difference(const PlantResponse& found, const PlantResponse& reference) {
  double largest = 0;
  for (const auto& floor : spectral_differences(found, reference))
    largest = std::max({largest, floor.horizontal, floor.vertical});
  return largest;
}

}  // namespace rths::plant::test
