// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/bearing.hpp>

namespace rths::test {

/// The paper's lead-rubber bearing, without additional effects.
inline constexpr double kStrength = 1.010e6;            ///< Q_d [N]
inline constexpr double kPostYieldStiffness = 4.238e6;  ///< K_d [N/m]
inline constexpr double kInitialStiffness = 3.58e8;     ///< K_1 [N/m]
inline constexpr double kAxialLoad = 9.7e6;             ///< mean [N]
inline constexpr double kYieldDisplacement =
    kStrength / (kInitialStiffness - kPostYieldStiffness);  ///< u_y [m]

inline sim::Bearing plain_lead_rubber() {
  return {"plain lead-rubber bearing",
          {{"bouc_wen",
            "",
            {{"characteristic_strength", kStrength},
             {"post_yield_stiffness", kPostYieldStiffness},
             {"yield_displacement", kYieldDisplacement}}}},
          kAxialLoad};
}

/// Returns the force of a bearing that is independent of velocity and load.
inline Eigen::Vector2d moved(sim::BearingRun& bearing, const Eigen::Vector2d& displacement) {
  return bearing.advance(displacement, Eigen::Vector2d::Zero(), kAxialLoad);
}

}  // namespace rths::test
