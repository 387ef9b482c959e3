// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rths/sim/composition.hpp>

#include "opensees_paths.hpp"

namespace rths::sim::test_support {

/// The same bearing as an OpenSees element and as a composition.
struct TwoBearings {
  nlohmann::json element;  ///< name and the arguments after the two nodes
  nlohmann::json friction_models = nlohmann::json::array();
  nlohmann::json materials = nlohmann::json::array();
  std::vector<TermSettings> terms;
  double axial_load = 0;          ///< mean, > 0 compresses [N]
  double vertical_stiffness = 0;  ///< converts the load into a displacement [N/m]
};

/// Restoring force at each step: long, lat, axial (> 0 compresses) [N].
using Forces = std::vector<std::array<double, 3>>;

/// Forces of OpenSees' element along a path. @throws std::runtime_error with OpenSees' error output
[[nodiscard]] Forces opensees_forces(const TwoBearings& bearing, const Path& path);
/// Forces of the composition along a path.
[[nodiscard]] Forces our_forces(const TwoBearings& bearing, const Path& path);

/// RMS of the difference over the RMS of the reference about its mean [-].
struct Nrmse {
  double shear = 0;  ///< both axes together
  double axial = 0;  ///< for a constant reference: over its RMS
};
[[nodiscard]] Nrmse nrmse(const Forces& ours, const Forces& reference);

}  // namespace rths::sim::test_support
