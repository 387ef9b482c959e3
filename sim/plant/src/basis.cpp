// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/basis.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::plant {
namespace {

constexpr std::size_t kNodesOfPicture = 500;
constexpr Index kModesOfPicture = 4;
constexpr int kPasses = 3;         // of Gram-Schmidt
constexpr double kOwnPart = 1e-9;  // of a vector that the others do not contain, at least

/// Loads whose static deflections belong to a basis.
class StaticLoads {
 public:
  StaticLoads(const Structure& structure, const BearingSet& bearings)
      : structure_{structure}, bearings_{bearings}, map_{structure.bearing_motion()} {
    for (const std::size_t node : structure.bearings)
      for (std::size_t k = 0; k < 2; ++k)
        reach_ = std::max(reach_, std::abs(structure.nodes[node].place[k]));
    if (!(reach_ > 0)) reach_ = 1;
  }

  /// Forces of the bearings of a kind in one direction, as 1, x, y, xy, x², y².
  [[nodiscard]] VectorXd pattern(std::size_t kind, std::size_t direction,
                                 std::size_t pattern) const {
    VectorXd forces = VectorXd::Zero(map_.rows());
    for (std::size_t i = 0; i < structure_.bearings.size(); ++i) {
      if (bearings_.kind_of[i] != kind) continue;
      const auto& place = structure_.nodes[structure_.bearings[i]].place;
      const double x = place[0] / reach_, y = place[1] / reach_;
      forces[row_of(i, direction)] = std::array{1.0, x, y, x * y, x * x, y * y}[pattern];
    }
    return map_.transpose() * forces;
  }
  static constexpr std::size_t kPatterns = 6;

  [[nodiscard]] VectorXd of_bearing(std::size_t bearing, std::size_t direction) const {
    return map_.transpose() * VectorXd::Unit(map_.rows(), row_of(bearing, direction));
  }

  [[nodiscard]] std::vector<VectorXd> all(std::size_t tested) const {
    std::vector<VectorXd> loads;
    const MatrixXd inertia = structure_.inertia();
    for (std::size_t direction = 0; direction < kDirections; ++direction) {
      for (std::size_t kind = 0; kind < bearings_.kinds.size(); ++kind)
        for (std::size_t i = 0; i < kPatterns; ++i) loads.push_back(pattern(kind, direction, i));
      loads.emplace_back(inertia.col(static_cast<Index>(direction)));
      loads.push_back(of_bearing(tested, direction));
    }
    return loads;
  }

 private:
  static Index row_of(std::size_t bearing, std::size_t direction) {
    return static_cast<Index>(kDirections * bearing + direction);
  }

  const Structure& structure_;
  const BearingSet& bearings_;
  SparseMatrix map_;
  double reach_ = 0;
};

// Appends the parts of vectors that a basis does not contain, M-orthonormal.
void append(const std::vector<VectorXd>& vectors, const VectorXd& mass, MatrixXd& basis) {
  Index count = basis.cols();
  basis.conservativeResize(Eigen::NoChange, count + std::ssize(vectors));
  for (VectorXd rest : vectors) {
    const double size = std::sqrt(rest.dot(mass.cwiseProduct(rest)));
    if (!(size > 0)) continue;  // a pattern that no bearing has
    rest /= size;
    for (int pass = 0; pass < kPasses; ++pass)
      rest -= basis.leftCols(count) * (basis.leftCols(count).transpose() * mass.cwiseProduct(rest));
    const double length = std::sqrt(rest.dot(mass.cwiseProduct(rest)));
    if (length > kOwnPart) basis.col(count++) = rest / length;
  }
  basis.conservativeResize(Eigen::NoChange, count);
}

MatrixXd at_nodes(const MatrixXd& shapes, const Structure& structure,
                  const std::vector<std::size_t>& nodes) {
  MatrixXd rows(std::ssize(nodes) * static_cast<Index>(kDirections), shapes.cols());
  Index row = 0;
  for (const std::size_t node : nodes)
    for (const Index dof : structure.nodes[node].dofs) rows.row(row++) = shapes.row(dof);
  return rows;
}

MatrixXd places_of(const Structure& structure, const std::vector<std::size_t>& nodes) {
  MatrixXd places(3, std::ssize(nodes));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    places.col(static_cast<Index>(i)) =
        Eigen::Vector3d::Map(structure.nodes[nodes[i]].place.data());
  return places;
}

// Every so many of the nodes that move in all directions.
std::vector<std::size_t> nodes_of_picture(const Structure& structure) {
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < structure.nodes.size(); ++i) {
    const auto& dofs = structure.nodes[i].dofs;
    if (std::find(dofs.begin(), dofs.end(), kNoDof) == dofs.end()) moving.push_back(i);
  }
  const std::size_t stride = (moving.size() + kNodesOfPicture - 1) / kNodesOfPicture;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < moving.size(); i += stride) chosen.push_back(moving[i]);
  return chosen;
}

}  // namespace

std::string coordinate_name(Index coordinate) { return fmt::format("coordinate.{}", coordinate); }

VectorXd Basis::initial_frequencies() const {
  return stiffness.cwiseSqrt() / (2 * std::numbers::pi);
}

MatrixXd Basis::mass_shares() const {
  const auto along = Eigen::RowVector3d::Map(mass.data());
  return participation.array().square().rowwise() / along.array();
}

VectorXd static_weights(const Structure& structure, const BearingSet& bearings, Factor& factor) {
  const VectorXd load = -kStandardGravity * structure.inertia().col(2);
  VectorXd settlement;
  factor.solve(load, settlement);
  const VectorXd motion = structure.bearing_motion() * settlement;
  return -bearings.vertical_stiffness *
         motion.reshaped(3, std::ssize(structure.bearings)).row(2).transpose();
}

Basis make_basis(const Structure& structure, const BearingSet& bearings,
                 const BasisSettings& settings) {
  if (settings.tested_bearing >= structure.bearings.size())
    throw Error{fmt::format("basis: bearing {} is tested, but there are {}",
                            settings.tested_bearing + 1, structure.bearings.size())};
  const SparseMatrix initial = on_springs(structure, bearings, &BearingStiffness::initial);
  Factor on_initial{initial};
  Basis basis;
  MatrixXd shapes;
  {
    Factor on_post_yield{on_springs(structure, bearings, &BearingStiffness::post_yield)};
    StructureModes modes = modes_up_to(on_post_yield, structure.mass, settings.frequency_limit);
    basis.frequencies = std::move(modes.frequencies);
    shapes = std::move(modes.shapes);
  }
  if (settings.has_static_vectors) {
    std::vector<VectorXd> deflections;
    for (const VectorXd& load : StaticLoads{structure, bearings}.all(settings.tested_bearing)) {
      deflections.emplace_back();
      on_initial.solve(load, deflections.back());
    }
    append(deflections, structure.mass, shapes);
  }
  const MatrixXd reduced = shapes.transpose() * (initial * shapes);
  const maths::Modes principal = maths::symmetric_modes(0.5 * (reduced + reduced.transpose()));
  basis.stiffness = principal.values;
  basis.bearings = (structure.bearing_motion() * shapes) * principal.vectors;
  std::vector<std::size_t> floors;
  for (const auto& floor : structure.floors) floors.push_back(floor.node);
  basis.floors = at_nodes(shapes, structure, floors) * principal.vectors;
  basis.participation = principal.vectors.transpose() * (shapes.transpose() * structure.inertia());
  basis.weights = static_weights(structure, bearings, on_initial);
  for (std::size_t k = 0; k < kDirections; ++k) basis.mass[k] = structure.mass_along(k);
  basis.dofs = structure.dofs();
  const auto drawn = nodes_of_picture(structure);
  basis.nodes = places_of(structure, drawn);
  basis.bearing_places = places_of(structure, structure.bearings);
  basis.shapes = at_nodes(shapes, structure, drawn) *
                 principal.vectors.leftCols(std::min(kModesOfPicture, shapes.cols()));
  if (settings.keeps_all_shapes) basis.all_shapes = shapes * principal.vectors;
  return basis;
}

}  // namespace rths::plant
