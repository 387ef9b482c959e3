// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace rths::maths {

/// Delay of a measured signal behind its reference.
struct DelayIdentification {
  double cross_correlation = 0;  ///< lag of the largest correlation [s]; negative: it leads
  double minimum_rms = 0;        ///< shift of the smallest RMS difference [s]
};

/// Difference between a measured signal and its reference, without any shift.
struct TrackingError {
  double rms = 0;   ///< of the difference [m]
  double nrms = 0;  ///< RMS / largest |reference| [-]
  double peak = 0;  ///< largest difference / largest |reference| [-]
};

/// Delay by cross-correlation and by minimum RMS over shifts of whole samples, each refined by the
/// parabola through the best shift and its neighbours.
/// @param reference, measured  equally long, equally spaced in time
/// @param time_step  [s]
/// @param search     largest shift to either side [s]
/// @throws Error if the signals differ in length, are shorter than four searches, or are constant
/// @setup
[[nodiscard]] DelayIdentification identify_delay(std::span<const double> reference,
                                                 std::span<const double> measured, double time_step,
                                                 double search);

/// @throws Error if the signals differ in length or the reference is zero throughout   @setup
[[nodiscard]] TrackingError tracking_error(std::span<const double> reference,
                                           std::span<const double> measured);

}  // namespace rths::maths
