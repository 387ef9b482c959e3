// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/sim/ground_motion.hpp>

namespace rths::experiment {

/// Largest values of a component of a ground motion, without its drift.
struct MotionSizes {
  double acceleration = 0;  ///< [m/s²]
  double velocity = 0;      ///< [m/s]
  double displacement = 0;  ///< [m]
};
[[nodiscard]] MotionSizes sizes_of(const std::vector<double>& acceleration, double time_step);

/// Sizes of a motion that betray a wrong unit.
/// @param table  [motion] or [held_out], for the place and for `scale`   @param axes  tested ones
/// @returns what is unusual, but possible   @throws Error with the likely unit   @setup
[[nodiscard]] std::vector<std::string> check_motion(const Config& table,
                                                    const sim::GroundMotion& motion,
                                                    const std::vector<std::string>& axes);

/// Numbers that differ from those that they replace by the factor of a unit, such as kN as N.
/// @throws Error with the place and the likely unit of the first one   @setup
void check_units(const Config& changes, const Config& original);

}  // namespace rths::experiment
