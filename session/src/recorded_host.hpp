// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/experiment/experiment.hpp>
#include <rths/loop/tick_order.hpp>
#include <rths/recording/recording.hpp>

namespace rths::session {

using experiment::Experiment;

/// Requires that the rows of a recording follow the closed loop. From the first target on, a gap is
/// at most as long as five integration steps: between the ends of longer ones, targets and forces
/// are no straight lines.
/// @param name  of the recording, in errors
/// @throws Error with times and length of the first longer gap   @setup
void check_gaps(const Experiment& experiment, const recording::Reader& run,
                const std::string& name);

using experiment::Experiment;

/// Reads from a recording in which order controller and machine made their ticks, when the targets
/// arrived, and how long the solver computes while the host is not late.
/// @param ticks, period  of the controller; the period in wall time [s]
[[nodiscard]] loop::Host recorded_host(const Experiment& experiment, const recording::Reader& run,
                                       const recording::NodeTicks& ticks, double period);

/// Requires that the rows of a recording follow the closed loop. From the first target on, a gap is
/// at most as long as five integration steps: between the ends of longer ones, targets and forces
/// are no straight lines.
/// @param name  of the recording, in errors
/// @throws Error with times and length of the first longer gap   @setup
void check_gaps(const Experiment& experiment, const recording::Reader& run,
                const std::string& name);

}  // namespace rths::session
