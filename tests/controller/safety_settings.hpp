// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <rths/controller/safety.hpp>

namespace rths::controller {

/// Limits of the SRMD's lateral axis.
inline SafetySettings settings_of(std::size_t axes = 1) {
  SafetyLimits limits;
  limits.displacement = 0.6;
  limits.velocity = 0.95;
  limits.acceleration = 38;
  limits.jerk = 1500;
  limits.jump = 0.035;
  limits.force = 4.45e6;
  limits.tracking = 0.05;
  limits.feedback_jump = 0.01;
  limits.force_jump = 1e6;
  limits.returned_work = 4e5;
  limits.negative_work = 2e4;
  SafetySettings settings;
  settings.axes.assign(axes, limits);
  return settings;
}

}  // namespace rths::controller
