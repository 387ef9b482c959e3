// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/plant/structure.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::plant {

/// Response of a plant whose tested bearing is computed, too.
struct PlantResponse {
  double time_step = 0;
  MatrixXd tested;  ///< displacement of the tested bearing: long, lat; row by step [m]
  MatrixXd floors;  ///< absolute acceleration of the floors: long, lat, vert; row by step [m/s²]
};

/// @param plant   with the monitors of a large plant
/// @param tested  its tested bearing, under the weight that it carries
/// @throws Error as sim::BearingRun   @setup
[[nodiscard]] PlantResponse response_of(sim::Substructure& plant, const sim::Bearing& tested,
                                        double time_step, double duration);

/// Root mean square of the difference over that of the reference [-].
[[nodiscard]] double relative_difference(const MatrixXd& found, const MatrixXd& reference);

inline constexpr double kHighestOfSpectra = 33;  ///< [Hz]
/// Modes should reach this times the highest frequency of the spectra. Source: measured, with steps
/// of 1 ms.
inline constexpr double kModesOverSpectra = 1.4;

/// Largest relative difference of a floor's 5 % spectra from 0.3 to 33 Hz [-].
struct SpectralDifference {
  double horizontal = 0, vertical = 0;
};
/// @returns one for each floor   @setup
[[nodiscard]] std::vector<SpectralDifference> spectral_differences(const PlantResponse& found,
                                                                   const PlantResponse& reference);

}  // namespace rths::plant
