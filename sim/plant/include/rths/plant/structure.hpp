// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace rths::plant {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// Directions of a node: long, lat and up.
inline constexpr std::size_t kDirections = 3;
inline constexpr Index kNoDof = -1;

struct MeshNode {
  std::array<double, kDirections> place{};  ///< [m]
  std::array<Index, kDirections> dofs{kNoDof, kNoDof, kNoDof};
};

/// A place whose acceleration is wanted.
struct Floor {
  std::string name;
  std::size_t node = 0;
};

/// A finite-element structure without its bearings, in motion relative to the ground:
///     M ü + a₁ K u̇ + K u + Bᵀ f(B u, B u̇) = −M ι a_g,   B: the bearings' motion by u
struct Structure {
  SparseMatrix stiffness;  ///< K, dof × dof, symmetric; rigid-body motion has none [N/m]
  VectorXd mass;           ///< lumped, of each degree of freedom [kg]
  std::vector<MeshNode> nodes;
  std::vector<std::size_t> bearings;  ///< nodes on bearings
  std::vector<Floor> floors;
  /// B of bearings whose nodes have no degrees of freedom of their own, 3 × bearings rows; empty: B
  /// selects those of the nodes.
  SparseMatrix bearing_map;

  [[nodiscard]] Index dofs() const { return mass.size(); }
  /// Total mass that moves in a direction [kg].
  [[nodiscard]] double mass_along(std::size_t direction) const;
  /// M ι of each direction, dof × 3 [kg].
  [[nodiscard]] MatrixXd inertia() const;
  /// B, 3 × bearings rows.
  [[nodiscard]] SparseMatrix bearing_motion() const;
  /// K with a spring below each bearing node: along x and y, and up [N/m].
  /// @throws Error if there is not one for each bearing   @setup
  [[nodiscard]] SparseMatrix on_springs(const std::vector<std::array<double, 3>>& springs) const;
};

/// @throws Error naming the first row or node that is wrong: K not symmetric, a diagonal or a mass
///         that is not positive, a bearing or floor without its degrees of freedom   @setup
void check(const Structure& structure);

/// Nodes that move as one rigid body, such as a stiff mat, and the bearings below it.
struct RigidMat {
  std::vector<std::size_t> nodes;  ///< each with the same mass in all directions
  std::vector<std::array<double, kDirections>> bearings;  ///< places [m]
  bool turns = true;                                      ///< otherwise it only translates
};
/// The structure with the mat's constraint eliminated: u = T q, K → TᵀK T, M → TᵀM T. The first
/// coordinates are the translation of the mat's centre of mass, and its rotation about the
/// principal axes of its mass [rad]. So the mass stays diagonal.
/// @throws Error if there is no such node or bearing   @setup
[[nodiscard]] Structure on_rigid_mat(const Structure& structure, const RigidMat& mat);

}  // namespace rths::plant
