// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>

#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/plant/structure.hpp>

namespace rths::plant {
namespace {

using Place = std::array<double, kDirections>;

/// A rigid body: motion of its points from translation and rotation.
class RigidBody {
 public:
  RigidBody(const Structure& structure, const RigidMat& mat) : turns_{mat.turns} {
    double mass = 0;
    const auto mass_of = [&](std::size_t node) {
      return structure.mass[structure.nodes[node].dofs[0]];
    };
    for (const std::size_t node : mat.nodes) {
      mass += mass_of(node);
      centre_ += mass_of(node) * Eigen::Vector3d::Map(structure.nodes[node].place.data());
    }
    centre_ /= mass;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (const std::size_t node : mat.nodes) {
      const Eigen::Vector3d arm = arm_to(structure.nodes[node].place);
      inertia +=
          mass_of(node) * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    }
    axes_ = maths::symmetric_modes(inertia).vectors;
  }

  [[nodiscard]] Index dofs() const { return turns_ ? 6 : 3; }
  [[nodiscard]] Place centre() const { return {centre_[0], centre_[1], centre_[2]}; }

  /// Appends a point's motion in each direction to rows of a matrix, −1: none.
  void append(const Place& place, const std::array<Index, kDirections>& rows,
              std::vector<Eigen::Triplet<double>>& entries) const {
    for (Index k = 0; k < 3; ++k) {
      const Index row = rows[static_cast<std::size_t>(k)];
      if (row < 0) continue;
      entries.emplace_back(row, k, 1);
      if (!turns_) continue;
      for (Index axis = 0; axis < 3; ++axis)
        entries.emplace_back(row, 3 + axis, axes_.col(axis).cross(arm_to(place))[k]);
    }
  }

 private:
  [[nodiscard]] Eigen::Vector3d arm_to(const Place& place) const {
    return Eigen::Vector3d::Map(place.data()) - centre_;
  }

  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();
  bool turns_;
};

void require_nodes(const Structure& structure, const RigidMat& mat) {
  if (mat.nodes.empty() || mat.bearings.empty())
    throw Error{fmt::format("rigid mat: {} nodes on {} bearings, expected at least 1 of each",
                            mat.nodes.size(), mat.bearings.size())};
  for (const std::size_t node : mat.nodes)
    if (node >= structure.nodes.size() || structure.nodes[node].dofs[0] < 0)
      throw Error{fmt::format("rigid mat: node {} is none that moves", node + 1)};
}

SparseMatrix matrix_of(const std::vector<Eigen::Triplet<double>>& entries, Index rows,
                       Index columns) {
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// T of u = T q; also renumbers the degrees of freedom of the nodes.
SparseMatrix eliminate(const RigidBody& body, const std::vector<std::size_t>& rigid,
                       Structure& structure) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const std::size_t node : rigid) {
    body.append(structure.nodes[node].place, structure.nodes[node].dofs, entries);
    structure.nodes[node].dofs.fill(kNoDof);
  }
  Index count = body.dofs();
  for (auto& node : structure.nodes)
    for (Index& dof : node.dofs)
      if (dof >= 0) {
        entries.emplace_back(dof, count, 1);
        dof = count++;
      }
  return matrix_of(entries, structure.dofs(), count);
}

}  // namespace

Structure on_rigid_mat(const Structure& structure, const RigidMat& mat) {
  require_nodes(structure, mat);
  const RigidBody body{structure, mat};
  Structure result = structure;
  const SparseMatrix T = eliminate(body, mat.nodes, result), squares = T.cwiseProduct(T);
  result.stiffness = T.transpose() * SparseMatrix{structure.stiffness * T};
  result.mass = squares.transpose() * structure.mass;
  result.nodes.push_back({body.centre(), {0, 1, 2}});
  result.bearings.clear();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index row = 0; const auto& place : mat.bearings) {
    body.append(place, {row, row + 1, row + 2}, entries);
    row += 3;
    result.bearings.push_back(result.nodes.size());
    result.nodes.push_back({place, {kNoDof, kNoDof, kNoDof}});
  }
  result.bearing_map = matrix_of(entries, std::ssize(mat.bearings) * 3, result.dofs());
  return result;
}

}  // namespace rths::plant
