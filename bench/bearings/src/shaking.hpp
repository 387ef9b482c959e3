// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/step_times.hpp>

namespace rths::bench {

inline constexpr double kTimeStep = 1e-3;  ///< of everything that is measured [s]

/// How far a bearing is moved, and what it carries.
struct Demand {
  double amplitude = 0;           ///< of each axis [m]
  double axial_load = 0;          ///< mean [N]
  double vertical_stiffness = 0;  ///< load as vertical displacement [N/m]
};

/// Like a violent earthquake: both axes at once, many frequencies from 0.2 to 8 Hz, the load
/// varying by up to 80 %. The same on every machine.
[[nodiscard]] Shaking earthquake(const Demand& demand, int steps);

/// What no bearing meets and no step may take long for: jumps to and fro of all sizes up to a
/// thousand times the amplitude, everything at its stops, uplift and landing, standstill.
[[nodiscard]] Shaking adversity(const Demand& demand, int steps);

}  // namespace rths::bench
