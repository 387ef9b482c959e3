// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace rths::bench {

inline constexpr double kPreload = 10e6;   ///< mean load of the bearing [N]
inline constexpr double kForcePeak = 5e6;  ///< of the command around it [N]
inline constexpr double kHorizontalPeak = 0.2, kHorizontalFrequency = 0.4;  ///< [m], [Hz]

/// The vertical reaction that a plant commands, and the horizontal motion beside it.
///
/// The plant is a mass on a multilinear elastic spring, softer in decompression, with a dashpot;
/// its mode is at 9.5 Hz. A vertical ground motion with content to 20 Hz excites it. The reaction
/// is scaled to the peak and begins at the preload.
class VerticalCommand {
 public:
  explicit VerticalCommand(double duration);
  [[nodiscard]] double duration() const { return duration_; }
  [[nodiscard]] double force(double time) const;       ///< compression [N]
  [[nodiscard]] double horizontal(double time) const;  ///< [m]

 private:
  double duration_;
  std::vector<double> reaction_;  ///< around the preload, at 10 kHz [N]
};

}  // namespace rths::bench
