// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/maths/bands.hpp>
#include <rths/maths/delay.hpp>
#include <rths/maths/tracking.hpp>
#include <rths/recording/recording.hpp>

namespace rths::commissioning {

/// Signals to compare, and how.
struct DelayQuestion {
  std::string target = "command";         ///< role of an axis, or name of a signal
  std::string measured = "displacement";  ///< the same
  double window = 2;                      ///< [s]
  double search = 0.2;                    ///< largest delay to either side [s]
  double least_rms = 5e-4;                ///< of the target's motion, in its unit
};

/// Tracking in one window.
struct WindowTracking {
  double begin = 0;             ///< since the run began [s]
  maths::DelayFit fit;          ///< delay and gain of the best shape
  maths::DelayFit nearest;      ///< delay of the smallest RMS difference
  maths::FrequencyIndex index;  ///< phase and amplitude at the target's frequencies
  maths::TrackingError error;   ///< over the window
};

/// Tracking of a pair of signals.
struct PairTracking {
  std::string axis;                     ///< "long", "lat"; empty: signals by name
  std::string target, measured;         ///< names of the signals
  WindowTracking whole;                 ///< the whole recording
  std::vector<WindowTracking> windows;  ///< in which the target moves
  std::vector<maths::BandTracking> bands;

  [[nodiscard]] double median_delay() const;   ///< of the windows [s]
  [[nodiscard]] double largest_delay() const;  ///< by magnitude, with its sign [s]
};

/// Compares target and measurement of every tested axis, or one pair of signals.
/// @throws Error if a signal is missing, the recording is too short, or a target moves too little
/// @setup
[[nodiscard]] std::vector<PairTracking> track(const recording::Reader& run,
                                              const DelayQuestion& question);

/// Tables for a terminal.   @setup
[[nodiscard]] std::string text_of(const std::vector<PairTracking>& pairs);
/// One JSON document.   @setup
[[nodiscard]] std::string json_of(const std::vector<PairTracking>& pairs);

}  // namespace rths::commissioning
