// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/launch/run.hpp>
#include <rths/loop/tick_order.hpp>
#include <rths/recording/recording.hpp>

namespace rths::session {

using experiment::Experiment;

/// Reads from a recording in which order controller and machine made their ticks, when the targets
/// arrived, and how long the solver computes while the host is not late.
/// @param ticks, period  of the controller; the period in wall time [s]
[[nodiscard]] loop::Host recorded_host(const Experiment& experiment, const recording::Reader& run,
                                       const recording::NodeTicks& ticks, double period);

}  // namespace rths::session
