// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rths/sim/composition.hpp>

#include "opensees_paths.hpp"

namespace rths::sim::test {

/// A bearing, said twice: to OpenSees and as a composition.
struct TwoBearings {
  nlohmann::json element;  ///< name and arguments behind the two nodes
  nlohmann::json friction_models = nlohmann::json::array();
  nlohmann::json materials = nlohmann::json::array();
  std::vector<TermSettings> terms;
  double axial_load = 0;          ///< mean, > 0 compresses [N]
  double vertical_stiffness = 0;  ///< with which the load becomes a displacement [N/m]
};

/// Resisting force at each step: long, lat, axial (> 0 compresses) [N].
using Forces = std::vector<std::array<double, 3>>;

/// What OpenSees' element answers along a path. @throws std::runtime_error with what it said
[[nodiscard]] Forces opensees_forces(const TwoBearings& bearing, const Path& path);
/// What the composition answers along it.
[[nodiscard]] Forces our_forces(const TwoBearings& bearing, const Path& path);

/// Root mean square of the difference over that of the reference about its mean [-].
struct Nrmse {
  double shear = 0;  ///< both axes together
  double axial = 0;  ///< where the reference does not vary, over its root mean square
};
[[nodiscard]] Nrmse nrmse(const Forces& ours, const Forces& reference);

}  // namespace rths::sim::test
