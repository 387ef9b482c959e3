// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <rths/core/realtime.hpp>

namespace rths::sim {

/// A lead-plug rubber bearing under bidirectional shear: rubber in parallel with a lead core.
///
///     q = K_d u + Q_d z
///     dz = (1/u_y) (du − z |z|^(η−2) (z·du) (γ + β sgn(z·du))),   β + γ = 1,  so |z| ≤ 1
///
/// u_y = Q_d / (K_1 − K_d). Both axes share one z, so loading one direction softens the other.
/// The products are scalar products, hence the law does not depend on the choice of axes.
/// Source: Park, Wen & Ang (1986), in the rotation-invariant form.
struct LeadRubber {
  double characteristic_strength = 1.010e6;  ///< Q_d [N], > 0
  double post_yield_stiffness = 4.238e6;     ///< K_d [N/m], > 0
  double initial_stiffness = 3.58e8;         ///< K_1 [N/m], > K_d
  double beta = 0.5;                         ///< [-], 0…1
  double gamma = 0.5;                        ///< [-], 1 − β
  double eta = 2.0;                          ///< sharpness of the yield [-], ≥ 2

  /// u_y [m]
  [[nodiscard]] double yield_displacement() const {
    return characteristic_strength / (initial_stiffness - post_yield_stiffness);
  }
};

/// What a bearing remembers.
struct LeadRubberState {
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< u: long, lat [m]
  Eigen::Vector2d hysteresis = Eigen::Vector2d::Zero();    ///< z [-], |z| ≤ 1
};

/// Moves the bearing to `displacement` [m] and returns its restoring force [N].
///
/// Runge-Kutta over the displacement increment, in at most 64 parts of a twentieth of u_y each.
/// Rate-independent: time does not enter.   @realtime
[[nodiscard]] Eigen::Vector2d advance(const LeadRubber& bearing, LeadRubberState& state,
                                      const Eigen::Vector2d& displacement) RTHS_REALTIME;

}  // namespace rths::sim
