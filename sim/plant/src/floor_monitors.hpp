// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <rths/plant/structure.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::plant {

/// Of the ground and of each floor: long, lat and vert.   @setup
[[nodiscard]] std::vector<sim::MonitoredQuantity> monitors_of(std::size_t floors);
/// Their values.
/// @param ground   acceleration   @param floors  relative to the ground, 3 × floors   @realtime
void write_monitors(const Eigen::Vector3d& ground, const VectorXd& floors,
                    std::span<double> values) RTHS_REALTIME;

/// Acceleration of the ground: long, lat and up [m/s²].   @realtime
[[nodiscard]] Eigen::Vector3d ground_at(const sim::GroundMotion& motion, double time) RTHS_REALTIME;

}  // namespace rths::plant
