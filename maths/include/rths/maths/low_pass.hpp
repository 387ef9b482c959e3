// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <rths/core/realtime.hpp>

namespace rths::maths {

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

}  // namespace rths::maths
