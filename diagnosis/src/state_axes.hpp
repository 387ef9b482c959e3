// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "motion_drive.hpp"

namespace rths::diagnosis {

/// Work that is done on something and never given back, up to each step: what it is at its least
/// from there on, for all that is stored then is returned later.
/// @param power  into it, by step [W]
[[nodiscard]] Eigen::VectorXd dissipated_energy(const Eigen::VectorXd& power, double time_step);

/// Adds what a residual of forces is mapped over beside displacement and velocity: axial load,
/// temperature, control, acceleration of each axis, dissipated energy.
/// @param auxiliary  the channel that controls a device; null: none
void add_state_axes(const std::vector<std::size_t>& axes, bool predicts_force,
                    const Channel* auxiliary, MotionDrive& drive);

}  // namespace rths::diagnosis
