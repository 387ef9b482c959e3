// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/term.hpp>

#include "plane.hpp"

namespace rths::sim {

/// Adds a hysteretic force and a parallel spring to the specimen's force.
template <class Real>
void resist(Quantities<Real>& q, const Plane<Real>& plug, const Real& stiffness) {
  const Horizontal<Real> plugs{plug.x, plug.y};
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
    q.hysteretic_force[i] += plugs[i];
    q.force[i] += plugs[i] + stiffness * q.displacement[i];
  }
}

/// Displacement increment of this step, scaled by elastic stiffness / strength. So a modifier of
/// the strength keeps the stiffness before yield, and a weaker specimen yields earlier.
/// @param before  in: displacement of the last step; out: of this step
template <class Real>
Plane<Real> scaled_increment(const Quantities<Real>& q, Real* before) {
  constexpr double kWeakest = 1e-3;  // below it the force is negligible
  const Real strength = q.strength > kWeakest ? q.strength : Real{kWeakest};
  const Plane<Real> du{q.displacement[0] - before[0], q.displacement[1] - before[1]};
  before[0] = q.displacement[0], before[1] = q.displacement[1];
  return du * (q.elastic_stiffness / strength);
}

}  // namespace rths::sim
