// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <rths/sim/dual.hpp>
#include <rths/sim/term.hpp>

#include "plane.hpp"

namespace rths::sim {

// The kinds of elastomeric bearings by what they act on (docs/theory/lead_rubber.md). Within a
// stage they act in this order: first what the axial law needs, then the axial law.
std::span<const TermKind> elastomeric_vertical_kinds();
std::span<const TermKind> elastomeric_modifier_kinds();
std::span<const TermKind> lead_heating_kinds();
std::span<const TermKind> elastomeric_restoring_kinds();

/// A factor that would be negative is 0: strength and stiffness may be lost, not turned round.
template <class Real>
void scale(Real& quantity, const Real& factor) {
  quantity *= factor > 0 ? factor : Real{0};
}

/// How much of what a modifier does to the strength it does to the stiffness before yield, as a
/// power of it: 0 leaves the stiffness, 1 leaves the yield displacement.
inline constexpr Parameter kElasticShareParameter = {"elastic_share", "-", 0, 1, 0, 0.5};

template <class Real>
void weaken(Quantities<Real>& q, const Real& factor, const Real& elastic_share) {
  using std::pow;
  q.strength *= factor;
  if (!is_just(elastic_share, 0) && factor > 0) q.elastic_stiffness *= pow(factor, elastic_share);
}

}  // namespace rths::sim
