// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "motion_drive.hpp"

namespace rths::diagnosis {

/// Energy dissipated up to each step: the smallest value of the work done from that step on,
/// because stored energy is returned later.
/// @param power  input power, by step [W]
[[nodiscard]] VectorXd dissipated_energy(const VectorXd& power, double time_step);

/// Adds the states, besides displacement and velocity, over which a residual of forces is mapped:
/// axial load, temperature, control, acceleration of each axis, dissipated energy.
/// @param auxiliary  the channel that controls a device; null: none
void add_state_axes(const std::vector<std::size_t>& axes, bool predicts_force,
                    const Channel* auxiliary, MotionDrive& drive);

}  // namespace rths::diagnosis
