// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/dual.hpp>
#include <rths/sim/term.hpp>

#include "plane.hpp"

namespace rths::sim {

/// Multiplies by the factor, or by 0 if it is negative: strength and stiffness never change sign.
template <class Real>
void scale(Real& quantity, const Real& factor) {
  quantity *= factor > 0 ? factor : Real{0};
}

/// Exponent of a strength factor's effect on the stiffness before yield: 0 keeps the stiffness, 1
/// keeps the yield displacement.
inline constexpr Parameter kElasticShareParameter = {"elastic_share", "-", 0, 1, 0, 0.5};

template <class Real>
void weaken(Quantities<Real>& q, const Real& factor, const Real& elastic_share) {
  q.strength *= factor;
  if (!is_just(elastic_share, 0) && factor > 0) q.elastic_stiffness *= pow(factor, elastic_share);
}

}  // namespace rths::sim
