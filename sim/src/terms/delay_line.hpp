// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <rths/sim/dual.hpp>

namespace rths::sim {

/// Delayed signals, interpolated by Lagrange's cubic through the four nearest samples. A delay of
/// whole steps returns the sample itself. Before the first sample a signal is constant.
///
/// Stored in a term's state: slot of the newest sample, number of samples, samples of each signal.
template <class Real>
class DelayLine {
 public:
  static constexpr std::size_t kNodes = 4;

  /// Samples to store for ages up to `longest` [s].
  static std::size_t capacity(double longest, double time_step) {
    return static_cast<std::size_t>(std::ceil(longest / time_step)) + kNodes;
  }
  static std::size_t states(std::size_t capacity, std::size_t signals) {
    return 2 + signals * capacity;
  }

  DelayLine(Real* state, std::size_t capacity) : state_{state}, capacity_{capacity} {
    newest_ = static_cast<std::size_t>(value_of(state_[0]));
    count_ = static_cast<std::size_t>(value_of(state_[1]));
  }

  /// Begins a step, with a look-back of `age` [steps], 0 … capacity − 4.
  void advance(const Real& age) {
    newest_ = newest_ + 1 < capacity_ ? newest_ + 1 : 0;
    count_ = std::min(count_ + 1, capacity_);
    state_[0] = static_cast<double>(newest_);
    state_[1] = static_cast<double>(count_);
    const double whole = std::floor(value_of(age));
    first_ = whole > 1 ? std::min(static_cast<std::size_t>(whole) - 1, capacity_ - kNodes) : 0;
    const Real x = age - static_cast<double>(first_);
    const Real a = x - 1, b = x - 2, c = x - 3;
    weights_ = {a * b * c * (-1.0 / 6), x * b * c * 0.5, x * a * c * -0.5, x * a * b * (1.0 / 6)};
  }

  /// Stores a signal's newest sample and returns the delayed one.
  Real exchange(std::size_t signal, const Real& newest) {
    Real* samples = state_ + 2 + signal * capacity_;
    samples[newest_] = newest;
    Real sum{};
    for (std::size_t i = 0; i < kNodes; ++i)
      sum += weights_[i] * samples[slot(std::min(first_ + i, count_ - 1))];
    return sum;
  }

 private:
  // Slot of the sample that is `age` steps old.
  [[nodiscard]] std::size_t slot(std::size_t age) const {
    return newest_ >= age ? newest_ - age : newest_ + capacity_ - age;
  }

  Real* state_;
  std::size_t capacity_, newest_, count_, first_ = 0;
  std::array<Real, kNodes> weights_{};
};

/// x within [low, high].
template <class Real>
Real within(const Real& x, double low, double high) {
  if (x > high) return Real{high};
  if (x < low) return Real{low};
  return x;
}

}  // namespace rths::sim
