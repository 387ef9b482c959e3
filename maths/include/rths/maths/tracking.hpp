// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace rths::maths {

/// A measured signal as its reference, late and scaled: m(t) = g r(t − τ) + c + e(t), fitted by
/// least squares. With a free gain, τ is also the lag of the largest cross-correlation.
///
/// The intervals come from the residual and its correlation in time (Newey & West 1987), so it need
/// not be white.
struct DelayFit {
  double delay = 0;         ///< τ [s]; negative: the measured signal leads
  double gain = 1;          ///< g [-]
  double offset = 0;        ///< c [unit of the signals]
  double delay_95 = 0;      ///< half width of the 95 % interval [s]
  double gain_95 = 0;       ///< the same of g [-]; 0 if the gain is fixed
  double residual_rms = 0;  ///< of e [unit of the signals]
};

enum class Gain { Free, Fixed };

/// Fits delay, gain and offset. With a fixed gain of 1, τ is the delay of the smallest RMS
/// difference.
/// @param reference, measured  equally long, equally spaced in time
/// @param time_step  [s]
/// @param search     largest delay to either side [s]
/// @throws Error as identify_delay does   @setup
[[nodiscard]] DelayFit fit_delay(std::span<const double> reference,
                                 std::span<const double> measured, double time_step, double search,
                                 Gain gain = Gain::Free);

/// Response of a measured signal to its reference at the frequencies of the reference:
///     A = Σ M R* / Σ |R|²,   f = Σ f |R|² / Σ |R|²,   delay = −arg A / (2π f)
/// R, M: Fourier transforms, with a Hann window. Source: Guo, Chen, Xu & Chen (2014).
struct FrequencyIndex {
  double amplitude = 1;                   ///< |A| [-]
  double delay = 0;                       ///< [s], within half a period of `near`
  double frequency = 0;                   ///< f [Hz]
  double amplitude_95 = 0, delay_95 = 0;  ///< half widths of the 95 % intervals
};

/// @param near  a rough delay, which the signals are moved by before they are compared [s]
/// @throws Error if the signals differ in length, or the reference is constant   @setup
[[nodiscard]] FrequencyIndex frequency_index(std::span<const double> reference,
                                             std::span<const double> measured, double time_step,
                                             double near);

/// A window of a record: samples begin to begin + length.
struct Window {
  std::size_t begin = 0, length = 0;
};

/// Windows of equal length that overlap by half, in which the reference moves: its standard
/// deviation there is at least `least_rms`.   @setup
[[nodiscard]] std::vector<Window> moving_windows(std::span<const double> reference,
                                                 std::size_t length, double least_rms);

}  // namespace rths::maths
