// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "random.hpp"
#include "specimen.hpp"

namespace trial {

/// Three components of a ground motion [g].
struct GroundMotion {
  std::string name;
  double step = 0;  ///< [s]
  std::vector<double> first{}, second{}, vertical{};
  bool has_vertical = false;  ///< otherwise derived from the first component, sped up
};

/// @returns the ground motions in `motions`; if that folder has fewer than three, the records in
/// `records` and variants of these
std::vector<GroundMotion> read_ground_motions(const std::filesystem::path& motions,
                                              const std::filesystem::path& records);

/// Excitation of one record of a test, at every sample.
struct Excitation {
  std::string ground_motion{};
  double scale = 0;      ///< on the ground motion [-]
  bool swapped = false;  ///< the first component drives the lateral axis
  bool has_vertical = false;
  std::vector<Plane> ground{};       ///< [m/s²]
  std::vector<double> axial_load{};  ///< [N]
};

/// Cuts, tapers and scales a motion for a given displacement of the isolated structure.
/// @param reach  peak displacement on the bearing without effects [m]
Excitation excite(const GroundMotion& motion, double reach, Random& random);

}  // namespace trial
