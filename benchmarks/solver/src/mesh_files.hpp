// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <vector>

#include <rths/plant/ant.hpp>

namespace rths::bench {

/// Rows of numbers, separated by commas.
class Rows {
 public:
  explicit Rows(const std::filesystem::path& file) : out_{file} { out_.precision(17); }
  template <class First, class... Others>
  void add(const First& first, const Others&... others) {
    out_ << first;
    ((out_ << ',' << others), ...);
    out_ << '\n';
  }

 private:
  std::ofstream out_;
};

/// Writes a plant for `solid_plant.py`, which OpenSees runs.
/// @param springs  initial stiffness below each bearing node: long, lat, up [N/m]
inline void write_mesh(const std::filesystem::path& folder, const plant::AntMesh& mesh,
                       const plant::Structure& structure,
                       const std::vector<std::array<double, plant::kDirections>>& springs) {
  Rows nodes{folder / "nodes.csv"}, solids{folder / "solids.csv"}, moduli{folder / "moduli.csv"},
      below{folder / "springs.csv"};
  for (const auto& [place, dofs] : structure.nodes)
    nodes.add(place[0], place[1], place[2], structure.mass[dofs[0]]);
  for (const auto& [n, part] : mesh.solids)
    solids.add(n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], static_cast<int>(part));
  for (const double modulus : mesh.moduli) moduli.add(modulus, mesh.poisson_ratio);
  for (std::size_t i = 0; i < springs.size(); ++i)
    below.add(structure.bearings[i], springs[i][0], springs[i][1], springs[i][2]);
}

}  // namespace rths::bench
