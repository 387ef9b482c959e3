// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "random.hpp"
#include "specimen.hpp"

namespace trial {

/// Coloured noise: processes of Ornstein and Uhlenbeck, sampled exactly.
struct NoiseColour {
  double deviation = 0;                        ///< of their sum [unit of the channel]
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

/// What one channel adds to the truth.
struct ChannelNoise {
  NoiseColour displacement, acceleration, force, axial_load;
};

/// @param level  standard deviation over that of an ordinary recording [-]
ChannelNoise draw_noise(double level, Random& random);

/// The resolution that any recording has.
inline constexpr double kForceResolution = 100;          ///< [N]
inline constexpr double kDisplacementResolution = 1e-5;  ///< [m]
inline constexpr double kAccelerationResolution = 1e-3;  ///< [m/s²]
inline constexpr double kAxialResolution = 1000;         ///< [N]

double quantised(double value, double step);

/// From the force at the load cell to the voltage that is sampled. What it says at once goes into
/// the hybrid loop; what the recorder hears of it may come later.
class LoadCell {
 public:
  LoadCell(const Physics& physics, double step);
  void advance(const Plane& force, const Boundary& platen);

  [[nodiscard]] const Plane& at_once() const { return at_once_; }  ///< offset left out [N]
  [[nodiscard]] Plane recorded() const;                            ///< [N]

 private:
  Physics physics_;
  double step_, time_ = 0;
  Plane at_once_{}, lagged_{};
  std::vector<Plane> history_;
  std::size_t newest_ = 0;
};

/// @returns what the accelerometers on the platen say, noise left out [m/s²]
Plane accelerometer(const Physics& physics, const Boundary& platen);

}  // namespace trial
