// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <rths/maths/robust_covariance.hpp>
#include <rths/maths/tracking.hpp>

namespace rths::commissioning {

/// How the gains are found.
struct CalibrationSettings {
  double from = 0.1, to = 3;  ///< band of the fit [Hz]
  /// Part of the identified lag that the feed-forward compensates, the compensator has the rest
  /// [-].
  double feed_forward_share = 1.0 / 3;
};

/// Reference and displacement of one axis of a machine without compensation.
struct AxisCharacter {
  double interval = 0.001;  ///< [s]
  std::vector<double> reference, displacement;
};

/// The lead that makes a machine follow: reference = a0 x + a1 ẋ + a2 ẍ.
struct AxisCalibration {
  std::string name;                           ///< "long", "lat"
  std::array<maths::RobustEstimate, 3> lead;  ///< a0 [-], a1 [s], a2 [s²]
  maths::DelayFit delay;                      ///< of the machine, whole records
  double remaining = 0;  ///< RMS of x − lead of measured x over RMS of x, in the band [-]
};

/// Fits the lead to the measured response H of the machine: min Σ S |1 − (a0 + iω a1 − ω² a2) H|²
/// over the frequencies of the band, S: power of the reference. H = S_rx/S_rr, from averaged
/// spectra, has no bias from the noise of the displacement.
/// @throws Error if the records have too little motion in the band   @setup
[[nodiscard]] AxisCalibration calibrate_axis(const std::vector<AxisCharacter>& records,
                                             const CalibrationSettings& settings);

struct Calibration {
  std::vector<std::filesystem::path> files;
  CalibrationSettings settings;
  std::vector<AxisCalibration> axes;
  [[nodiscard]] double velocity_gain() const;           ///< of the feed-forward [s]
  [[nodiscard]] std::array<double, 3> initial() const;  ///< of ATS: mean of the axes less it
};

/// From recordings of characterisation tests.
/// @throws Error if a recording lacks a signal, or as calibrate_axis does   @setup
[[nodiscard]] Calibration calibrate(const std::vector<std::filesystem::path>& files,
                                    const CalibrationSettings& settings);

[[nodiscard]] std::string text_of(const Calibration& calibration);
[[nodiscard]] std::string json_of(const Calibration& calibration);
/// Gains of the blocks ats and feed_forward, as a file of `constants` of an experiment.
[[nodiscard]] std::string toml_of(const Calibration& calibration);

}  // namespace rths::commissioning
