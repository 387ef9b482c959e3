// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "specimen.hpp"

namespace trial {

using Signal = std::vector<double>;
using Spectrum = std::vector<std::complex<double>>;

/// In place, for a power of two; the inverse is not divided by the length.
void fourier(Spectrum& spectrum, bool inverse);

/// A signal padded with a smooth return to zero, so that nothing of its end appears at its start.
Spectrum spectrum_of(const Signal& signal);

/// @param response  at a frequency [Hz], two-sided; must be even in magnitude
/// @returns as many samples as asked for
Signal filtered(const Spectrum& spectrum, double sample_time, std::size_t samples,
                const std::function<std::complex<double>(double)>& response);

inline constexpr double kCompareRate = 62.5;  ///< of residuals [Hz]
inline constexpr double kCompareBand = 25;    ///< what is compared lies below [Hz]

/// Low-passed at kCompareBand without a shift in time, and sampled at kCompareRate.
Signal compared(const Signal& signal, double sample_time);

/// One axis of many planes.
Signal axis_of(const std::vector<Plane>& planes, std::size_t axis);

}  // namespace trial
