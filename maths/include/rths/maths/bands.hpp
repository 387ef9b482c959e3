// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace rths::maths {

/// Tracking in a band of frequencies.
struct BandTracking {
  /// Response of the measurement to the command.
  struct Response {
    double gain = 0;       ///< [-]
    double delay = 0;      ///< of the measurement behind the command [s]
    double coherence = 0;  ///< 0 to 1; the rest is noise or not linear [-]
  };
  double from = 0, to = 0;  ///< [Hz]
  double command = 0;       ///< RMS of the command in the band, over its largest magnitude [-]
  double nrms = 0;  ///< share of the band: the squares of all bands add up to NRMS squared [-]
  std::optional<Response> response;  ///< none: too little command, or too short a record
};

/// Tracking in bands of frequencies, which cover all frequencies. Gain, delay and coherence come
/// from averaged spectra of overlapping segments (Welch).
/// @param command, measured  equally long [m]
/// @param interval           [s]
/// @param delay              of the whole record; that of a band lies within half a period of it
/// [s]
[[nodiscard]] std::vector<BandTracking> track_bands(const std::vector<double>& command,
                                                    const std::vector<double>& measured,
                                                    double interval, double delay);

/// Linear dependence of a measurement on its command, by frequency.
struct Coherence {
  std::vector<double> frequency;  ///< [Hz], without 0
  std::vector<double> value;      ///< 0 to 1 [-]
  /// @returns the smallest value in [from, to]; none without a frequency there
  [[nodiscard]] std::optional<double> least(double from, double to) const;
};

/// From the same averaged spectra as the bands; empty if the record is too short for them.
/// @param command, measured  equally long   @param interval  [s]
[[nodiscard]] Coherence coherence_of(const std::vector<double>& command,
                                     const std::vector<double>& measured, double interval);

}  // namespace rths::maths
