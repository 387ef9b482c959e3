// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/term.hpp>

namespace rths::sim {

/// Deflection w of an axis under the specimen's force F: w = clip(χ F, limit), x = u − w.
///
/// F depends on x and is computed after it. With an estimate K of the specimen's largest stiffness,
/// the stiff component K x is solved for implicitly. The remainder R = F − K x is extrapolated from
/// the last two steps:
///     x = (u − χ R*) / (1 + χ K),   R* = 2 R₋₁ − R₋₂
/// An error decays by g = χ (K − K_t)/(1 + χ K) per step (as g^½ where g > 0), with the tangent
/// stiffness K_t. The scheme is stable for 0 ≤ K_t < 4/3 K + 1/(3 χ) at any time step, and of
/// second order in the step.
///
/// The specimen receives the velocity of u, not of x. A velocity from differences of x would feed
/// back a stiffness c/Δt for every damping c of the specimen, which exceeds any K as Δt falls.
template <class Real>
class Compliance {
 public:
  static constexpr std::size_t kStates = 2;  ///< x and R of the last step

  Compliance(Real* state, const Real& flexibility, const Real& stiffness)
      : state_{state}, flexibility_{flexibility}, stiffness_{stiffness} {}

  /// @param u      of the held end [m]
  /// @param force  of the specimen in the last step [N]
  /// @returns x, of the specimen's end [m]
  Real yield(const Real& u, const Real& force, const Real& limit) {
    const Real rest = force - stiffness_ * state_[0];
    const Real next_rest = 2 * rest - state_[1];
    Real x = (u - flexibility_ * next_rest) / (1 + flexibility_ * stiffness_);
    const Real w = u - x;
    if (w > limit) x = u - limit;
    if (w < -limit) x = u + limit;
    state_[0] = x;
    state_[1] = rest;
    return x;
  }

 private:
  Real* state_;
  Real flexibility_, stiffness_;
};

inline constexpr Parameter kStiffnessEstimate = {"stiffness_estimate", "N/m", 0, 1e15, 4e8, 4e8};

}  // namespace rths::sim
