// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Fixed lead from the command's own rates, added to a compensator's reference u:
///     r = u + k_v ẋ + k_a ẍ
/// A servo whose position loop has gain K_v lags by v/K_v; k_v compensates for that.
struct FeedForward {
  double velocity_gain = 0;      ///< k_v [s]
  double acceleration_gain = 0;  ///< k_a [s²]

  /// @param reference [m] @param velocity [m/s] @param acceleration [m/s²] @returns r [m] @realtime
  [[nodiscard]] double operator()(double reference, double velocity,
                                  double acceleration) const RTHS_REALTIME {
    return reference + velocity_gain * velocity + acceleration_gain * acceleration;
  }
};

}  // namespace rths::controller
