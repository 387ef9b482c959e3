// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "specimen.hpp"

namespace trial {

using Signal = std::vector<double>;
using Spectrum = std::vector<std::complex<double>>;

/// In place, for a length that is a power of two. The inverse is not divided by the length.
void fourier(Spectrum& spectrum, bool inverse);

/// Spectrum of a signal that is padded with a smooth return to zero, so that its end does not wrap
/// around to its start.
Spectrum spectrum_of(const Signal& signal);

/// @param response  at a frequency [Hz], two-sided, of even magnitude
/// @returns `samples` samples
Signal filtered(const Spectrum& spectrum, double sample_time, std::size_t samples,
                const std::function<std::complex<double>(double)>& response);

inline constexpr double kCompareRate = 62.5;  ///< of residuals [Hz]
inline constexpr double kCompareBand = 25;    ///< upper limit of compared signals [Hz]

/// Low-passes a signal at kCompareBand without a time shift and samples it at kCompareRate.
Signal compared(const Signal& signal, double sample_time);

/// Returns one axis of all samples.
Signal axis_of(const std::vector<Plane>& planes, std::size_t axis);

}  // namespace trial
