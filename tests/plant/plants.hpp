// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/plant/ant.hpp>
#include <rths/plant/basis.hpp>

namespace rths::plant::test {

/// The lead-rubber bearing of the paper. Its force does not depend on velocity or load.
[[nodiscard]] sim::Bearing lead_rubber();

/// The smallest plant, of 5,676 degrees of freedom, made once for all tests of a process.
struct LargePlant {
  AntMesh mesh;
  Structure structure;
  BearingSet bearings;
};
[[nodiscard]] const LargePlant& large_plant();
/// Its basis with the default settings.
[[nodiscard]] const Basis& large_basis();

/// Elements in a row along x, each 2 × 3 × 4 m, on a bearing at each of their lower nodes.
struct BoxDesign {
  int elements = 1;
  double modulus = 1e9, poisson_ratio = 0.3, density = 2000;
};
/// With a floor "top" at the last upper node.
[[nodiscard]] AntMesh boxes(const BoxDesign& design);
inline constexpr double kBoxLong = 2, kBoxLat = 3, kBoxHeight = 4;  ///< [m]

}  // namespace rths::plant::test
