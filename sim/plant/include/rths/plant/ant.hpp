// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <rths/plant/structure.hpp>

namespace rths::plant {

inline constexpr int kAntBearingsLong = 27, kAntBearingsLat = 18;
/// Numbered along lat first.
inline constexpr std::size_t kAntBearings = std::size_t{kAntBearingsLong} * kAntBearingsLat;
/// Numbers of bearings that a model of the plant may have.
inline constexpr std::array kAntModels{std::size_t{1}, std::size_t{5}, kAntBearings};
/// Floors at 47.5 m.
inline constexpr std::array kAntFloors{"containment_47.5", "internal_47.5", "auxiliary_47.5"};

/// The parts of the plant. The first one is the flexible basemat.
enum class PlantPart : std::size_t { Basemat, Containment, Internal, Auxiliary };
inline constexpr std::size_t kParts = 4;

/// A nuclear plant on a flexible basemat above 27 × 18 bearings, of solid elements on a grid:
/// containment (a cylinder with a roof at 70 m), internal structure (a cylinder) and auxiliary
/// building (a block with a hole), all to 47.5 m at least.
///
/// The paper gives no drawings, masses or frequencies. All values are ours. The modulus of each
/// building follows from its frequency on a fixed base.
struct AntDesign {
  int plan = 1;                                                 ///< elements between two bearings
  int mat_layers = 1;                                           ///< elements through the basemat
  int levels = 2;                                               ///< elements up to 47.5 m
  std::array<double, kParts> masses{145e6, 72e6, 72e6, 191e6};  ///< [kg]
  std::array<double, kParts> frequencies{0, 4.4, 5.9, 7.6};     ///< first, on a fixed base [Hz]
  double basemat_modulus = 30e9;                                ///< [Pa]
  double poisson_ratio = 0.2;
  /// One of kAntModels. Fewer than kAntBearings stand for all of them, below a rigid mat.
  std::size_t bearings = kAntBearings;

  [[nodiscard]] double mass() const;  ///< of all parts [kg]
};

/// An element with eight nodes, a box along the axes: four below, four above, counterclockwise.
struct Solid {
  std::array<std::size_t, 8> nodes{};
  PlantPart part{};
};

/// The mesh of a plant, for other programs too.
struct AntMesh {
  std::vector<MeshNode> nodes;
  std::vector<Solid> solids;
  std::vector<std::size_t> bearings;       ///< nodes
  std::vector<Floor> floors;               ///< kAntFloors
  std::array<double, kParts> densities{};  ///< [kg/m³]
  std::array<double, kParts> moduli{};     ///< [Pa]
  double poisson_ratio = 0;
};

/// The design with the number of degrees of freedom nearest to `dofs`, from 5,676 to 98,007.
/// @setup
[[nodiscard]] AntDesign ant_with(long dofs);
/// Places of the bearings of a model, along long and lat from the centre, numbered along lat first
/// [m]. Five stand at the centre and at the corners of a rectangle, so that their second moments
/// of area are those of all.
/// @throws Error if there is no such model   @setup
[[nodiscard]] std::vector<std::array<double, 2>> ant_bearing_places(std::size_t bearings);
/// With a node at each of kAntBearings.
/// @throws Error if the design has no element in a direction   @setup
[[nodiscard]] AntMesh mesh_of(const AntDesign& design);
/// Trilinear solids, fully integrated, with lumped masses.   @setup
[[nodiscard]] Structure assemble(const AntMesh& mesh);
/// The same with the mat rigid, above the bearings of a model. One bearing at the centre cannot
/// resist overturning: the mat only translates.
/// @throws Error as ant_bearing_places   @setup
[[nodiscard]] Structure assemble_on_rigid_mat(const AntMesh& mesh, std::size_t bearings);
/// One part on a fixed base: without the nodes that it shares with the basemat.   @setup
[[nodiscard]] Structure on_fixed_base(const AntMesh& mesh, PlantPart part);

}  // namespace rths::plant
