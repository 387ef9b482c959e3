// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Attenuates one frequency, by the bilinear transform, pre-warped there:
///     (s² + 2 depth ζ ω s + ω²)/(s² + 2 ζ ω s + ω²)
/// The first input is its state at rest.
class Notch {
 public:
  using Weights = std::array<double, 3>;  ///< of this sample and the two before

  /// Lets everything pass.
  Notch() = default;
  /// @param frequency  [Hz], below half the sampling rate   @param damping  ζ > 0 [-]
  /// @param depth      gain at the frequency, 0 to 1 [-]    @param period   of the samples [s]
  /// @throws Error if one is out of range   @setup
  Notch(double frequency, double damping, double depth, double period);
  /// @realtime
  [[nodiscard]] double operator()(double input) RTHS_REALTIME;
  [[nodiscard]] const Weights& numerator() const { return inputs_; }
  [[nodiscard]] const Weights& denominator() const { return outputs_; }  ///< the first is 1

 private:
  Weights inputs_{1, 0, 0}, outputs_{1, 0, 0};
  double z1_ = 0, z2_ = 0;  ///< transposed direct form II
  bool has_started_ = false;
};

/// Mean of the last `length` samples, or of all samples while there are fewer.
class MovingAverage {
 public:
  /// @throws Error if length < 1   @setup
  explicit MovingAverage(int length);
  /// @realtime
  [[nodiscard]] double operator()(double input) RTHS_REALTIME;

 private:
  std::vector<double> samples_;
  std::size_t next_ = 0, count_ = 0;
};

/// Rate of a noisy signal: the slope, at the newest sample, of the parabola fitted to the last
/// `length` samples by least squares. No lag for motion up to constant acceleration.
class EndSlope {
 public:
  /// @param length  samples fitted, ≥ 3   @throws Error otherwise   @setup
  EndSlope(int length, double period);
  /// @returns the rate [unit/s]; 0 until there are enough samples   @realtime
  [[nodiscard]] double operator()(double input) RTHS_REALTIME;

 private:
  std::vector<double> weights_;  ///< of the samples, newest first
  std::vector<double> samples_;
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace rths::controller
