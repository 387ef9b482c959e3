// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "random.hpp"
#include "specimen.hpp"

namespace trial {

/// Three components of a ground motion, as read [g].
struct GroundMotion {
  std::string name;
  double step = 0;  ///< [s]
  std::vector<double> first{}, second{}, vertical{};
  bool has_vertical = false;  ///< else it is made from the first, faster
};

/// @returns those in `motions`; or, where that folder is absent, variants of the records in
/// `records`, so that at least three differ
std::vector<GroundMotion> read_ground_motions(const std::filesystem::path& motions,
                                              const std::filesystem::path& records);

/// What one record of a test is driven by, at every sample.
struct Excitation {
  std::string ground_motion{};
  double scale = 0;      ///< on the ground motion [-]
  bool swapped = false;  ///< its first component drives the lateral axis
  bool has_vertical = false;
  std::vector<Plane> ground{};       ///< [m/s²]
  std::vector<double> axial_load{};  ///< [N]
};

/// Cuts, tapers and scales, so that the isolated structure moves about as far as it should.
/// @param reach  largest displacement on the bearing as it was meant to be [m]
Excitation excite(const GroundMotion& motion, double reach, Random& random);

}  // namespace trial
