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
std::span<const TermKind> asymmetric_kinds();
std::span<const TermKind> controlled_kinds();

/// Adds what a specimen resists with to its force: what dissipates, and a spring beside it.
template <class Real>
void resist(Quantities<Real>& q, const Plane<Real>& plug, const Real& stiffness) {
  const Horizontal<Real> plugs{plug.x, plug.y};
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
    q.hysteretic_force[i] += plugs[i];
    q.force[i] += plugs[i] + stiffness * q.displacement[i];
  }
}

/// The way since the last step, as long as it seems to a specimen whose strength is a factor off:
/// stiffness before yield stays unless a modifier says otherwise, so what is weaker yields earlier.
/// @param before  displacement of the last step; this one's afterwards
template <class Real>
Plane<Real> scaled_increment(const Quantities<Real>& q, Real* before) {
  constexpr double kWeakest = 1e-3;  // less has no force to speak of
  const Real strength = q.strength > kWeakest ? q.strength : Real{kWeakest};
  const Plane<Real> du{q.displacement[0] - before[0], q.displacement[1] - before[1]};
  before[0] = q.displacement[0], before[1] = q.displacement[1];
  return du * (q.elastic_stiffness / strength);
}

}  // namespace rths::sim
