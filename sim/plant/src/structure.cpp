// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/structure.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::plant {
namespace {

constexpr double kSymmetry = 1e-9;  // of the larger diagonal of both rows

void check_symmetry(const SparseMatrix& K) {
  const VectorXd diagonal = K.diagonal();
  const SparseMatrix transposed = K.transpose();
  const SparseMatrix difference = K - transposed;
  for (Index column = 0; column < difference.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry{difference, column}; entry; ++entry) {
      const double scale = std::max(diagonal[entry.row()], diagonal[entry.col()]);
      if (std::abs(entry.value()) <= kSymmetry * scale) continue;
      throw Error{fmt::format(
          "stiffness: row {} column {} is {:g}, but row {} column {} is {:g}, expected a symmetric "
          "matrix",
          entry.row() + 1, entry.col() + 1, K.coeff(entry.row(), entry.col()), entry.col() + 1,
          entry.row() + 1, K.coeff(entry.col(), entry.row()))};
    }
}

void check_node(const Structure& structure, std::size_t node, const std::string& what) {
  if (node >= structure.nodes.size())
    throw Error{fmt::format("{} is at node {}, but there are {} nodes", what, node + 1,
                            structure.nodes.size())};
  for (std::size_t i = 0; i < kDirections; ++i)
    if (const Index dof = structure.nodes[node].dofs[i]; dof < 0 || dof >= structure.dofs())
      throw Error{
          fmt::format("{} is at node {}, whose degree of freedom {} is {}, expected 1 to {}", what,
                      node + 1, "xyz"[i], dof + 1, structure.dofs())};
}

}  // namespace

double Structure::mass_along(std::size_t direction) const {
  double sum = 0;
  for (const auto& node : nodes)
    if (node.dofs[direction] >= 0) sum += mass[node.dofs[direction]];
  return sum;
}

MatrixXd Structure::inertia() const {
  MatrixXd result = MatrixXd::Zero(dofs(), kDirections);
  for (const auto& node : nodes)
    for (std::size_t i = 0; i < kDirections; ++i)
      if (const Index dof = node.dofs[i]; dof >= 0) result(dof, static_cast<Index>(i)) = mass[dof];
  return result;
}

SparseMatrix Structure::on_springs(const std::vector<std::array<double, 3>>& springs) const {
  if (springs.size() != bearings.size())
    throw Error{fmt::format("plant: {} bearings are given, but the structure has {}",
                            springs.size(), bearings.size())};
  VectorXd diagonal(std::ssize(springs) * 3);
  for (std::size_t i = 0; i < springs.size(); ++i)
    diagonal.segment<3>(static_cast<Index>(kDirections * i)) =
        Eigen::Vector3d::Map(springs[i].data());
  const SparseMatrix B = bearing_motion();
  const SparseMatrix forces = diagonal.asDiagonal() * B;
  const SparseMatrix added = B.transpose() * forces;
  return stiffness + added;
}

SparseMatrix Structure::bearing_motion() const {
  if (bearing_map.rows() > 0) return bearing_map;
  std::vector<Eigen::Triplet<double>> entries;
  Index row = 0;
  for (const std::size_t node : bearings)
    for (const Index dof : nodes[node].dofs) entries.emplace_back(row++, dof, 1);
  SparseMatrix map(row, dofs());
  map.setFromTriplets(entries.begin(), entries.end());
  return map;
}

void check(const Structure& structure) {
  const SparseMatrix& K = structure.stiffness;
  if (K.rows() != structure.dofs() || K.cols() != structure.dofs())
    throw Error{fmt::format("stiffness is {} × {}, but there are {} masses, expected as many",
                            K.rows(), K.cols(), structure.dofs())};
  const VectorXd diagonal = K.diagonal();
  for (Index row = 0; row < structure.dofs(); ++row) {
    if (!(diagonal[row] > 0) || !std::isfinite(diagonal[row]))
      throw Error{
          fmt::format("stiffness: the diagonal of row {} is {:g}, expected a positive number",
                      row + 1, diagonal[row])};
    if (!(structure.mass[row] > 0) || !std::isfinite(structure.mass[row]))
      throw Error{fmt::format("mass: row {} is {:g} kg, expected a positive number", row + 1,
                              structure.mass[row])};
  }
  check_symmetry(K);
  if (structure.bearings.empty()) throw Error{"the structure has no bearings, expected at least 1"};
  if (structure.bearing_map.rows() == 0)
    for (std::size_t i = 0; i < structure.bearings.size(); ++i)
      check_node(structure, structure.bearings[i], fmt::format("bearing {}", i + 1));
  for (const auto& floor : structure.floors)
    check_node(structure, floor.node, "floor '" + floor.name + "'");
}

}  // namespace rths::plant
