// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include <rths/sim/term.hpp>

namespace rths::sim {

std::span<const TermKind> linear_actuator_kinds();
std::span<const TermKind> actuator_limit_kinds();

inline constexpr std::size_t kMotionSignals = 3;  ///< displacement, velocity, acceleration

template <class Real>
std::array<Real*, kMotionSignals> motion_of(Quantities<Real>& q, std::size_t axis) {
  return {&q.displacement[axis], &q.velocity[axis], &q.acceleration[axis]};
}

}  // namespace rths::sim
