// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Butterworth low-pass of even order by the bilinear transform. The cut-off is pre-warped, so the
/// gain there is exactly 1/√2. Starts at rest.
class LowPass {
 public:
  /// @param order    2, 4, 6 or 8
  /// @param cutoff   [Hz], below half the sampling rate
  /// @param period   of the samples [s]
  /// @throws Error if one is out of range   @setup
  LowPass(int order, double cutoff, double period);
  /// @realtime
  [[nodiscard]] double operator()(double input) RTHS_REALTIME;
  /// Filters a signal in place: the same values as one call per sample, in half the time.
  /// @realtime, if the signal is short
  void filter(std::span<double> signal) RTHS_REALTIME;
  /// Filters four signals in place, each from rest: the same values as `filter` of each, in less
  /// than half the time. An element holds a sample of all four.
  void filter_four(std::span<std::array<double, 4>> signals) const RTHS_REALTIME;

 private:
  template <class Call>
  void with_sections(const Call& call) const RTHS_REALTIME;
  template <std::size_t kSections>
  void filter_by(std::span<double> signal) RTHS_REALTIME;
  template <std::size_t kSections>
  void filter_four_by(std::span<std::array<double, 4>> signals) const RTHS_REALTIME;

  struct Section {
    double b0, a1, a2;      // b = b0·(1, 2, 1)
    double z1 = 0, z2 = 0;  // transposed direct form II
  };
  std::vector<Section> sections_;
};

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
