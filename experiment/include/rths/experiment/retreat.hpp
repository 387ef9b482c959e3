// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include <rths/core/realtime.hpp>

namespace rths::experiment {

/// The path to the safe state: hold the last command, then ramp it to rest along a cosine bell.
struct Retreat {
  double hold = 0.2;  ///< [s]
  double ramp = 1.0;  ///< [s], > 0

  /// Fraction of the held value to command `since` seconds into the retreat: 1 … 0.   @realtime
  [[nodiscard]] double fraction(double since) const RTHS_REALTIME {
    const double x = (since - hold) / ramp;
    if (x <= 0) return 1;
    return x >= 1 ? 0 : 0.5 * (1 + std::cos(std::numbers::pi * x));
  }
  /// @realtime
  [[nodiscard]] bool finished(double since) const RTHS_REALTIME { return since >= hold + ramp; }
};

}  // namespace rths::experiment
