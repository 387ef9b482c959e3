// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hybrid_test.hpp"
#include "spectrum.hpp"

namespace trial {

inline constexpr double kModelStep = 2e-3;  ///< for forces under a given motion [s]

/// A motion of the platen at every kModelStep.
using Motion = std::vector<Boundary>;

/// Returns the true motion of the platen.
Motion true_motion(const Record& record);

/// Estimates the motion from the record: low frequencies from the displacement, high ones from the
/// acceleration.
/// @param wrong  physics whose known accelerometer errors are removed
Motion measured_motion(const Record& record, const Physics& wrong, const ChannelNoise& noise);

/// Returns one draw of such an estimate's error due to noise, to be added to a motion.
Motion motion_error(const ChannelNoise& noise, Random& random);

Motion sum(const Motion& motion, const Motion& error);

/// Returns the load cell's force under a given motion without noise, sampled like the motion [N].
std::vector<Plane> force_at(const Physics& physics, const Motion& motion);

/// Returns the platen's response to the sent command under its true load, at every sample [m].
std::vector<Plane> displacement_at(const Physics& physics, const Record& record);

}  // namespace trial
