// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hybrid_test.hpp"
#include "spectrum.hpp"

namespace trial {

inline constexpr double kModelStep = 2e-3;  ///< of forces at a given motion [s]

/// A motion of the platen at every kModelStep.
using Motion = std::vector<Boundary>;

/// How the platen really moved.
Motion true_motion(const Record& record);

/// The same as one who only has the record would estimate it: slow parts from the displacement,
/// quick ones from the acceleration.
/// @param wrong  physics whose error of the accelerometers is known and taken out
Motion measured_motion(const Record& record, const Physics& wrong, const ChannelNoise& noise);

/// What noise does to such an estimate; one draw, to be added to a motion.
Motion motion_error(const ChannelNoise& noise, Random& random);

Motion sum(const Motion& motion, const Motion& error);

/// The load cell at a given motion, noise left out. Sampled like the motion [N].
std::vector<Plane> force_at(const Physics& physics, const Motion& motion);

/// How the platen follows what was sent, under the load that it had. At every sample [m].
std::vector<Plane> displacement_at(const Physics& physics, const Record& record);

}  // namespace trial
