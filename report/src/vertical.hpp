// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ticks.hpp"

namespace rths::report {

/// @param rate   wall time over model time
/// @param first  model time of the first target [s]
/// @returns nothing if the controller does not control the vertical force
[[nodiscard]] std::optional<VerticalAnalysis> analyse_vertical(const Reader& run,
                                                               const Ticks& ticks,
                                                               const Roles& roles, double rate,
                                                               double first);

}  // namespace rths::report
