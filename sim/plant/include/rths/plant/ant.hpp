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
/// @throws Error if the design has no element in a direction   @setup
[[nodiscard]] AntMesh mesh_of(const AntDesign& design);
/// Trilinear solids, fully integrated, with lumped masses.   @setup
[[nodiscard]] Structure assemble(const AntMesh& mesh);
/// One part on a fixed base: without the nodes that it shares with the basemat.   @setup
[[nodiscard]] Structure on_fixed_base(const AntMesh& mesh, PlantPart part);

}  // namespace rths::plant
