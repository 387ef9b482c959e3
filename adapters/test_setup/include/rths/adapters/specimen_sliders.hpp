// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/sim/bearing.hpp>

namespace rths::adapters {

/// Parallel sliders in place of a specimen: see controller::TargetForce.
struct SpecimenSliders {
  std::vector<double> sharp, smooth;  ///< reaches, ascending [m]; the last sharp one is the spring
  std::vector<double> strengths;      ///< of the sharp ones, then of the smooth ones [N]
};

/// The fewest sliders whose force is that of a bearing within half a percent, on a first move from
/// rest at a speed of strong motion; at most seven.   @setup
[[nodiscard]] SpecimenSliders sliders_of(const sim::Bearing& bearing);

}  // namespace rths::adapters
