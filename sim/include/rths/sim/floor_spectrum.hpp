// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace rths::sim {

/// Frequencies spaced evenly in their logarithm [Hz].
[[nodiscard]] std::vector<double> spectrum_frequencies(double lowest, double highest, int count);

/// Floor response spectrum of motion in two directions.
///
/// For each frequency, a damped oscillator stands on the floor in each direction. The value is the
/// largest magnitude over time of the vector of their two absolute accelerations. The oscillator is
/// solved exactly for acceleration linear between samples (Nigam & Jennings 1969), at 20 points or
/// more per period. So a peak is underestimated by 1.2 % at most, whatever the sampling rate.
/// @param long_acceleration, lat_acceleration  absolute, of the floor [m/s²], equally long
/// @param time_step  [s]
/// @param frequencies  of the oscillators [Hz], > 0
/// @param damping_ratio  [-], 0 < ζ < 1
/// @returns spectral acceleration, one per frequency [m/s²]   @setup
[[nodiscard]] std::vector<double> floor_spectrum(std::span<const double> long_acceleration,
                                                 std::span<const double> lat_acceleration,
                                                 double time_step,
                                                 std::span<const double> frequencies,
                                                 double damping_ratio);

}  // namespace rths::sim
