// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/term.hpp>

#include "plane.hpp"

namespace rths::sim {

// Work of the hysteretic force. The force of this step is not known yet, so the work is computed
// with the last force over the interval from the middle of the last step to the middle of this one.
// Over a history this equals the trapezoidal rule.
inline constexpr std::size_t kWorkStates = 4;  // displacements one and two steps before

// A `share` of the work is computed as |force| |increment|, whatever the angle between the two.
template <class Real>
Real work_taken(Real* before, const Quantities<Real>& q, const Real& share) {
  const Plane<Real> force{q.last_hysteretic_force[0], q.last_hysteretic_force[1]};
  const Plane<Real> increment{(q.displacement[0] - before[2]) * Real{0.5},
                              (q.displacement[1] - before[3]) * Real{0.5}};
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
    before[2 + i] = before[i];
    before[i] = q.displacement[i];
  }
  const Real work = dot(force, increment);
  if (is_just(share, 0)) return work;
  return work + share * (length(force) * length(increment) - work);
}

}  // namespace rths::sim
