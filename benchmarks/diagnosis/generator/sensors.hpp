// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "random.hpp"
#include "specimen.hpp"

namespace trial {

/// Coloured noise: a sum of exactly sampled Ornstein–Uhlenbeck processes.
struct NoiseColour {
  double deviation = 0;                        ///< of the sum [unit of the channel]
  std::array<double, 3> share{0.7, 0.2, 0.1};  ///< of the variance
  std::array<double, 3> corner_Hz{150, 8, 0.8};

  [[nodiscard]] double density(double frequency_Hz) const;  ///< two-sided [unit²/Hz]
};

class Noise {
 public:
  Noise(const NoiseColour& colour, double sample_time, Random& random);
  double next(Random& random);

 private:
  std::array<double, 3> value_{}, keep_{}, kick_{};
};

/// Noise of each channel.
struct ChannelNoise {
  NoiseColour displacement, acceleration, force, axial_load;
};

/// @param level  standard deviation relative to that of a typical recorded signal [-]
ChannelNoise draw_noise(double level, Random& random);

/// Default resolution of recordings.
inline constexpr double kForceResolution = 100;          ///< [N]
inline constexpr double kDisplacementResolution = 1e-5;  ///< [m]
inline constexpr double kAccelerationResolution = 1e-3;  ///< [m/s²]
inline constexpr double kAxialResolution = 1000;         ///< [N]

double quantised(double value, double step);

/// From the force at the load cell to the sampled signal. The hybrid loop uses the undelayed
/// signal; the recorder may receive a delayed one.
class LoadCell {
 public:
  LoadCell(const Physics& physics, double step);
  void advance(const Plane& force, const Boundary& platen);

  [[nodiscard]] const Plane& undelayed() const { return undelayed_; }  ///< without offset [N]
  [[nodiscard]] Plane recorded() const;                                ///< [N]

 private:
  Physics physics_;
  double step_, time_ = 0;
  Plane undelayed_{}, lagged_{};
  std::vector<Plane> history_;
  std::size_t newest_ = 0;
};

/// @returns output of the accelerometers on the platen, without noise [m/s²]
Plane accelerometer(const Physics& physics, const Boundary& platen);

}  // namespace trial
