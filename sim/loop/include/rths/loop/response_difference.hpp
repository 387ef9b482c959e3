// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/loop/numerical_response.hpp>

namespace rths::loop {

/// Of the bearing's displacement in both directions: root mean square of the difference over that
/// of the reference [-].
[[nodiscard]] double displacement_difference(const ResponseHistory& found,
                                             const ResponseHistory& reference);

inline constexpr double kHighestOfSpectra = 33;  ///< the band of nuclear practice [Hz]

/// Largest relative difference of a floor's 5 % spectra from 0.3 to 33 Hz [-].
struct SpectralDifference {
  double horizontal = 0, vertical = 0;  ///< vertical: 0 if it is not monitored
};
/// @param found, reference  of the same floors and the same time step
/// @returns one for each floor   @setup
[[nodiscard]] std::vector<SpectralDifference> spectral_differences(
    const ResponseHistory& found, const ResponseHistory& reference);

}  // namespace rths::loop
