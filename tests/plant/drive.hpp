// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/plant/large_plant_analysis.hpp>
#include <rths/plant/reduction_check.hpp>

namespace rths::plant::test {

/// Petrolia 1992, all three components.
/// @param scale  factor on the record
[[nodiscard]] sim::GroundMotion petrolia(double scale = 1);

inline constexpr double kTimeStep = 0.001;  ///< of most runs [s]

/// Largest difference of the spectra of all floors in all directions [-].
[[nodiscard]] double spectral_difference(const PlantResponse& found,
                                         const PlantResponse& reference);

}  // namespace rths::plant::test
