// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/plant/structure.hpp>

namespace rths::plant {

/// Files of a structure, in SI units. Rows, columns and nodes count from 1.
struct StructureFiles {
  std::filesystem::path stiffness;  ///< Matrix Market: coordinate real, symmetric or general [N/m]
  std::filesystem::path mass;       ///< Matrix Market: the same, diagonal [kg]
  std::filesystem::path nodes;      ///< table: node, x_m, y_m, z_m, dof_x, dof_y, dof_z; 0: none
  std::filesystem::path bearings;   ///< table: node
  std::filesystem::path floors;     ///< table: name, node

  /// k.mtx, m.mtx, nodes.csv, bearings.csv and floors.csv.
  [[nodiscard]] static StructureFiles in(const std::filesystem::path& folder);
};

/// Nodes may have any positive numbers; they keep their order.
///
/// A structure whose units are wrong is not found here: see its weight on each bearing, and its
/// first frequency.
/// @throws Error naming file and line, what was found and what was expected; and as `check`  @setup
[[nodiscard]] Structure read_structure(const StructureFiles& files);

/// Numbers are written with 17 digits: reading them again gives the same ones. Of the stiffness,
/// the lower triangle is written.
/// @throws Error as `check`, for a floor's name that has no place in a table, and if a file cannot
///         be written   @setup
void write_structure(const Structure& structure, const StructureFiles& files);

}  // namespace rths::plant
