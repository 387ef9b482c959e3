// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <rths/sim/term.hpp>

namespace rths::sim {

std::span<const TermKind> friction_kinds();
std::span<const TermKind> drag_kinds();
std::span<const TermKind> mount_kinds();
std::span<const TermKind> spring_kinds();
std::span<const TermKind> table_kinds();

/// x within ±limit.
template <class Real>
Real clipped(const Real& x, const Real& limit) {
  if (x > limit) return limit;
  if (x < -limit) return -limit;
  return x;
}

}  // namespace rths::sim
