// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace rths::recording {

/// The integration step, from 0, in which the model time of a target lies; negative before the
/// first. Targets of an α-method lie within their step, others at its end.
[[nodiscard]] inline long step_at(double time, double step) {
  constexpr double kRounding = 0.01;  // of a recorded time, over a step
  return static_cast<long>(std::ceil(time / step - kRounding)) - 1;
}

}  // namespace rths::recording
