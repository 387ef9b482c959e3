// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <rths/sim/term.hpp>

#include "plane.hpp"

namespace rths::sim {

std::span<const TermKind> bouc_wen_kinds();
std::span<const TermKind> plastic_kinds();
std::span<const TermKind> iwan_kinds();
std::span<const TermKind> model_form_kinds();

/// Adds what a specimen resists with to its force: what dissipates, and a spring beside it.
template <class Real>
void resist(Quantities<Real>& q, const Plane<Real>& plug, const Real& stiffness) {
  const Horizontal<Real> plugs{plug.x, plug.y};
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
    q.hysteretic_force[i] += plugs[i];
    q.force[i] += plugs[i] + stiffness * q.displacement[i];
  }
}

template <class Real>
Plane<Real> displacement_of(const Quantities<Real>& q) {
  return {q.displacement[0], q.displacement[1]};
}

}  // namespace rths::sim
