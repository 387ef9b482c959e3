// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Equal poles in series that smooth a signal and differentiate it. Each is y += h/(h + T)(u − y),
/// so (u − y)/T is exactly the backward difference of y. The first input is its state at rest.
template <int kPoles>
class PoleChain {
 public:
  /// @param time_constant  T of each pole, > 0 [s]   @param period  h, > 0 [s]
  PoleChain(double time_constant, double period) : gain_{period / (period + time_constant)} {}

  void advance(double input) RTHS_REALTIME {
    if (!has_started_) poles_.fill(input);
    has_started_ = true;
    poles_[0] = input;
    for (std::size_t i = 1; i <= kPoles; ++i) poles_[i] += gain_ * (poles_[i - 1] - poles_[i]);
  }

  /// Derivative of an order up to kPoles of the last pole's output, times T to the power of it.
  [[nodiscard]] double difference(int order) const RTHS_REALTIME {
    double sum = 0;
    double binomial = 1;
    for (int j = 0; j <= order; ++j) {
      sum += (j % 2 != 0 ? -1 : 1) * binomial *
             poles_[static_cast<std::size_t>(kPoles) - static_cast<std::size_t>(order - j)];
      binomial = binomial * (order - j) / (j + 1);
    }
    return sum;
  }

 private:
  double gain_;
  std::array<double, kPoles + 1> poles_{};  ///< the input, then each output
  bool has_started_ = false;
};

}  // namespace rths::controller
