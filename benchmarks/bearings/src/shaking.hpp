// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/step_times.hpp>

namespace rths::bench {

inline constexpr double kTimeStep = 1e-3;  ///< of all measurements [s]

/// Motion and load of a bearing.
struct Demand {
  double amplitude = 0;           ///< of each axis [m]
  double axial_load = 0;          ///< mean [N]
  double vertical_stiffness = 0;  ///< converts the load to vertical displacement [N/m]
};

/// A strong earthquake: both axes at once, many frequencies from 0.2 to 8 Hz, load variation up to
/// 80 %. The same on every machine.
[[nodiscard]] Shaking earthquake(const Demand& demand, int steps);

/// A worst case beyond any real motion, to bound the time of a step: jumps in both directions up to
/// a thousand times the amplitude, stops, uplift and landing, standstill.
[[nodiscard]] Shaking adversity(const Demand& demand, int steps);

}  // namespace rths::bench
