// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/ant.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/plant/modes.hpp>

namespace rths::plant {
namespace {

using ElementMatrix = Eigen::Matrix<double, 24, 24>;

constexpr double kSideLong = 110, kSideLat = 90;  // of the area that the bearings share [m]
constexpr double kMatThickness = 4;               // [m]
constexpr double kFloorElevation = 47.5, kRoofElevation = 70;                             // [m]
constexpr double kContainmentInner = 19.5, kContainmentOuter = 24, kInternalRadius = 15;  // [m]
constexpr double kAuxiliaryHole = 28, kAuxiliaryLong = 46, kAuxiliaryLat = 38;            // [m]
constexpr double kTrialModulus = 1e9;  // of a building before its frequency is known [Pa]

std::size_t index_of(PlantPart part) { return static_cast<std::size_t>(part); }

/// Corners of a box in the order of its nodes.
constexpr int kCorners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

/// The grid of a design; nodes are made as elements ask for them.
class Grid {
 public:
  explicit Grid(const AntDesign& design)
      : design_{design},
        columns_{(kAntBearingsLong - 1) * design.plan},
        rows_{(kAntBearingsLat - 1) * design.plan},
        width_{kSideLong / kAntBearingsLong / design.plan},
        depth_{kSideLat / kAntBearingsLat / design.plan},
        height_{kFloorElevation / design.levels},
        roof_levels_{
            std::max(design.levels + 1, static_cast<int>(std::lround(kRoofElevation / height_)))} {}

  AntMesh mesh() {
    for (int layer = 0; layer < design_.mat_layers; ++layer)
      for (int i = 0; i < columns_; ++i)
        for (int j = 0; j < rows_; ++j) add(i, j, layer, PlantPart::Basemat);
    for (int i = 0; i < columns_; ++i)
      for (int j = 0; j < rows_; ++j) add_above(i, j);
    for (int i = 0; i < kAntBearingsLong; ++i)
      for (int j = 0; j < kAntBearingsLat; ++j)
        mesh_.bearings.push_back(node(i * design_.plan, j * design_.plan, 0, PlantPart::Basemat));
    mesh_.floors = {{kAntFloors[0], nearest(22, 0, PlantPart::Containment)},
                    {kAntFloors[1], nearest(0, 0, PlantPart::Internal)},
                    {kAntFloors[2], nearest(36, 30, PlantPart::Auxiliary)}};
    return std::move(mesh_);
  }

 private:
  // The buildings above an element of the mat.
  void add_above(int i, int j) {
    const double x = left() + (i + 0.5) * width_, y = front() + (j + 0.5) * depth_;
    const double radius = std::hypot(x, y);
    const auto add_to = [&](PlantPart part, int top) {
      for (int level = 0; level < top; ++level) add(i, j, design_.mat_layers + level, part);
    };
    const bool is_wall = radius >= kContainmentInner && radius < kContainmentOuter;
    if (is_wall) add_to(PlantPart::Containment, roof_levels_);
    if (radius < kInternalRadius) add_to(PlantPart::Internal, design_.levels);
    if (radius < kContainmentOuter && !is_wall)
      add(i, j, design_.mat_layers + roof_levels_ - 1, PlantPart::Containment);
    if (radius >= kAuxiliaryHole && std::abs(x) < kAuxiliaryLong && std::abs(y) < kAuxiliaryLat)
      add_to(PlantPart::Auxiliary, design_.levels);
  }

  void add(int i, int j, int level, PlantPart part) {
    Solid solid;
    solid.part = part;
    for (std::size_t k = 0; k < 8; ++k)
      solid.nodes[k] = node(i + kCorners[k][0], j + kCorners[k][1], level + kCorners[k][2], part);
    mesh_.solids.push_back(solid);
  }

  // Buildings share their lowest nodes with the mat, and none with each other.
  std::size_t node(int i, int j, int level, PlantPart part) {
    if (level <= design_.mat_layers) part = PlantPart::Basemat;
    const auto [at, is_new] = known_.try_emplace({i, j, level, part}, mesh_.nodes.size());
    if (is_new) {
      const int above = level - design_.mat_layers;
      const double up = above <= 0 ? above * kMatThickness / design_.mat_layers : above * height_;
      mesh_.nodes.push_back({{left() + i * width_, front() + j * depth_, up}, {}});
      auto& dofs = mesh_.nodes.back().dofs;
      for (std::size_t k = 0; k < kDirections; ++k)
        dofs[k] = static_cast<Index>(kDirections * at->second + k);
    }
    return at->second;
  }

  [[nodiscard]] std::size_t nearest(double x, double y, PlantPart part) const {
    std::size_t best = 0;
    double least = 1e9;
    for (const auto& [key, node] : known_) {
      if (std::get<PlantPart>(key) != part) continue;
      const auto& place = mesh_.nodes[node].place;
      constexpr double kFloorWeight = 10;  // a level matters more than a place on it
      const double distance = std::hypot(place[0] - x, place[1] - y) +
                              kFloorWeight * std::abs(place[2] - kFloorElevation);
      if (distance < least) best = node, least = distance;
    }
    return best;
  }

  [[nodiscard]] double left() const { return -0.5 * width_ * columns_; }
  [[nodiscard]] double front() const { return -0.5 * depth_ * rows_; }

  AntDesign design_;
  int columns_, rows_;
  double width_, depth_, height_;
  int roof_levels_;
  AntMesh mesh_;
  std::map<std::tuple<int, int, int, PlantPart>, std::size_t> known_;
};

std::array<double, 3> size_of(const AntMesh& mesh, const Solid& solid) {
  const auto &low = mesh.nodes[solid.nodes[0]].place, &high = mesh.nodes[solid.nodes[6]].place;
  return {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
}

double volume_of(const AntMesh& mesh, const Solid& solid) {
  const auto size = size_of(mesh, solid);
  return size[0] * size[1] * size[2];
}

// Source: Zienkiewicz & Taylor, The Finite Element Method (2000), volume 1, chapters 6 and 8.
Eigen::Matrix<double, 6, 6> elasticity(double modulus, double poisson_ratio) {
  const double scale = modulus / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  Eigen::Matrix<double, 6, 6> D = Eigen::Matrix<double, 6, 6>::Zero();
  D.topLeftCorner<3, 3>().setConstant(scale * poisson_ratio);
  D.topLeftCorner<3, 3>().diagonal().setConstant(scale * (1 - poisson_ratio));
  D.bottomRightCorner<3, 3>().diagonal().setConstant(scale * (1 - 2 * poisson_ratio) / 2);
  return D;
}

// Strains at a point of a box, ξ in −1…1, by the motion of its corners.
Eigen::Matrix<double, 6, 24> strains_at(const std::array<double, 3>& size,
                                        const std::array<double, 3>& xi) {
  Eigen::Matrix<double, 6, 24> B = Eigen::Matrix<double, 6, 24>::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    std::array<double, 3> side{}, factor{};
    for (std::size_t k = 0; k < 3; ++k) {
      side[k] = 2 * kCorners[corner][k] - 1;
      factor[k] = (1 + side[k] * xi[k]) / 2;
    }
    const double x = side[0] / size[0] * factor[1] * factor[2];
    const double y = side[1] / size[1] * factor[0] * factor[2];
    const double z = side[2] / size[2] * factor[0] * factor[1];
    const int at = 3 * corner;
    B(0, at) = B(3, at + 1) = B(5, at + 2) = x;
    B(1, at + 1) = B(3, at) = B(4, at + 2) = y;
    B(2, at + 2) = B(4, at + 1) = B(5, at) = z;
  }
  return B;
}

ElementMatrix stiffness_of(const std::array<double, 3>& size, double modulus,
                           double poisson_ratio) {
  const auto D = elasticity(modulus, poisson_ratio);
  const double gauss = 1 / std::numbers::sqrt3;
  ElementMatrix K = ElementMatrix::Zero();
  for (const auto& corner : kCorners) {
    const auto B = strains_at(size, {gauss * (2 * corner[0] - 1), gauss * (2 * corner[1] - 1),
                                     gauss * (2 * corner[2] - 1)});
    K += B.transpose() * D * B * (size[0] * size[1] * size[2] / 8);
  }
  return K;
}

/// Element matrices, which are the same for all boxes of one size and part.
class SolidMatrices {
 public:
  explicit SolidMatrices(const AntMesh& mesh) : mesh_{mesh} {}
  const ElementMatrix& of(const Solid& solid) {
    const auto size = size_of(mesh_, solid);
    constexpr double kSame = 1e-6;  // [m]
    const auto rounded = [&](double length) { return std::lround(length / kSame); };
    const auto [at, is_new] =
        known_.try_emplace({rounded(size[0]), rounded(size[1]), rounded(size[2]), solid.part});
    if (is_new)
      at->second = stiffness_of(size, mesh_.moduli[index_of(solid.part)], mesh_.poisson_ratio);
    return at->second;
  }

 private:
  const AntMesh& mesh_;
  std::map<std::tuple<long, long, long, PlantPart>, ElementMatrix> known_;
};

// Assembles elements into the degrees of freedom of the structure's nodes.
template <class Includes>
void add_solids(const AntMesh& mesh, const Includes& includes, Structure& structure, Index dofs) {
  std::vector<Eigen::Triplet<double>> entries;
  structure.mass = VectorXd::Zero(dofs);
  SolidMatrices matrices{mesh};
  for (const auto& solid : mesh.solids) {
    if (!includes(solid)) continue;
    const ElementMatrix& K = matrices.of(solid);
    const double share = volume_of(mesh, solid) * mesh.densities[index_of(solid.part)] / 8;
    const auto dof_of = [&](std::size_t i) {
      return structure.nodes[solid.nodes[i / kDirections]].dofs[i % kDirections];
    };
    for (std::size_t i = 0; i < 24; ++i) {
      const Index row = dof_of(i);
      if (row < 0) continue;
      structure.mass[row] += share;
      for (std::size_t j = 0; j < 24; ++j)
        if (const Index column = dof_of(j); column >= 0)
          entries.emplace_back(row, column, K(static_cast<Index>(i), static_cast<Index>(j)));
    }
  }
  structure.stiffness.resize(dofs, dofs);
  structure.stiffness.setFromTriplets(entries.begin(), entries.end());
}

// Stiffness follows from the frequency: it is proportional to the modulus.
void tune(const AntDesign& design, AntMesh& mesh) {
  mesh.moduli = {design.basemat_modulus, kTrialModulus, kTrialModulus, kTrialModulus};
  for (const PlantPart part : {PlantPart::Containment, PlantPart::Internal, PlantPart::Auxiliary}) {
    const Structure building = on_fixed_base(mesh, part);
    Factor factor{building.stiffness};
    const double found = lowest_modes(factor, building.mass, 1).frequencies[0];
    const double ratio = design.frequencies[index_of(part)] / found;
    mesh.moduli[index_of(part)] *= ratio * ratio;
  }
}

}  // namespace

double AntDesign::mass() const { return std::accumulate(masses.begin(), masses.end(), 0.0); }

AntDesign ant_with(long dofs) {
  struct Size {
    long dofs;
    int plan, mat_layers, levels;
  };
  constexpr Size kSizes[] = {
      {5'676, 1, 1, 2}, {14'352, 1, 1, 9}, {47'952, 2, 1, 8}, {98'007, 2, 2, 18}};
  const auto& size = *std::min_element(
      std::begin(kSizes), std::end(kSizes), [&](const Size& one, const Size& other) {
        return std::abs(one.dofs - dofs) < std::abs(other.dofs - dofs);
      });
  AntDesign design;
  design.plan = size.plan;
  design.mat_layers = size.mat_layers;
  design.levels = size.levels;
  return design;
}

std::vector<std::array<double, 2>> ant_bearing_places(std::size_t bearings) {
  if (std::ranges::find(kAntModels, bearings) == kAntModels.end())
    throw Error{
        fmt::format("plant: {} bearings, expected {}", bearings, fmt::join(kAntModels, ", "))};
  if (bearings == 1) return {{0, 0}};
  constexpr double kWidth = kSideLong / kAntBearingsLong, kDepth = kSideLat / kAntBearingsLat;
  std::vector<std::array<double, 2>> all;
  for (int i = 0; i < kAntBearingsLong; ++i)
    for (int j = 0; j < kAntBearingsLat; ++j)
      all.push_back({(i - 0.5 * (kAntBearingsLong - 1)) * kWidth,
                     (j - 0.5 * (kAntBearingsLat - 1)) * kDepth});
  if (bearings == kAntBearings) return all;
  // n places in a row at equal distances d have the mean square d² (n² − 1)/12.
  const auto reach = [](double distance, int places) {
    return distance * std::sqrt(5. / 4 * (places * places - 1) / 12);
  };
  const double x = reach(kWidth, kAntBearingsLong), y = reach(kDepth, kAntBearingsLat);
  return {{-x, -y}, {-x, y}, {0, 0}, {x, -y}, {x, y}};
}

AntMesh mesh_of(const AntDesign& design) {
  if (design.plan < 1 || design.mat_layers < 1 || design.levels < 1)
    throw Error{fmt::format(
        "plant: {} elements between bearings, {} through the mat and {} up to the floors, expected "
        "at least 1 of each",
        design.plan, design.mat_layers, design.levels)};
  AntMesh mesh = Grid{design}.mesh();
  mesh.poisson_ratio = design.poisson_ratio;
  std::array<double, kParts> volumes{};
  for (const auto& solid : mesh.solids) volumes[index_of(solid.part)] += volume_of(mesh, solid);
  for (std::size_t i = 0; i < kParts; ++i) mesh.densities[i] = design.masses[i] / volumes[i];
  tune(design, mesh);
  return mesh;
}

Structure assemble(const AntMesh& mesh) {
  Structure structure;
  structure.nodes = mesh.nodes;
  structure.bearings = mesh.bearings;
  structure.floors = mesh.floors;
  add_solids(
      mesh, [](const Solid&) { return true; }, structure,
      static_cast<Index>(kDirections * mesh.nodes.size()));
  return structure;
}

Structure assemble_on_rigid_mat(const AntMesh& mesh, std::size_t bearings) {
  RigidMat mat;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if (mesh.nodes[node].place[2] <= 0) mat.nodes.push_back(node);
  for (const auto& [x, y] : ant_bearing_places(bearings))
    mat.bearings.push_back({x, y, -kMatThickness});
  mat.turns = bearings > 1;
  return on_rigid_mat(assemble(mesh), mat);
}

Structure on_fixed_base(const AntMesh& mesh, PlantPart part) {
  Structure structure;
  structure.nodes = mesh.nodes;
  for (auto& node : structure.nodes) node.dofs.fill(kNoDof);
  Index dofs = 0;
  for (const auto& solid : mesh.solids)
    for (const std::size_t node : solid.nodes) {
      auto& [place, own] = structure.nodes[node];
      if (solid.part != part || place[2] <= 0 || own[0] >= 0) continue;
      for (Index& dof : own) dof = dofs++;
    }
  add_solids(
      mesh, [&](const Solid& solid) { return solid.part == part; }, structure, dofs);
  return structure;
}

}  // namespace rths::plant
