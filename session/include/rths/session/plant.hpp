// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <rths/experiment/experiment.hpp>

// The large plant of an experiment, as texts for a terminal.
// @throws Error if its plant is none   @setup
namespace rths::session {

/// Computes and keeps the modes of a plant on a fixed base, too; those on bearings are read or
/// computed with the experiment.
[[nodiscard]] std::string build_plant(const experiment::Experiment& experiment);

/// Size, the first modes and the masses that move in them, loads of the bearings.
[[nodiscard]] std::string describe_plant(const experiment::Experiment& experiment, int modes);

/// Differences of a reduced plant from one of all degrees of freedom, and whether its modes reach
/// far enough: tested displacement and floor spectra under the motion, with a computed specimen.
/// @param duration  of the motion, from its begin [s]
[[nodiscard]] std::string check_plant(const experiment::Experiment& experiment, double duration);

/// Displacement of a bearing relative to the ground at each target of a run that recorded the
/// plant's coordinates, as a table: time [s], along long, lat and up [m].
/// @param recording  names its experiment   @param bearing  from 1
/// @throws Error if the run has no coordinates, or those of another plant   @setup
[[nodiscard]] std::string motion_of_bearing(const std::filesystem::path& recording, int bearing);

/// The displacement field at the target next to a time: place [m] and displacement relative to the
/// ground [m] of each node that has degrees of freedom; those of a rigid mat have none.
/// @throws Error as motion_of_bearing, and if the run has no such time   @setup
[[nodiscard]] std::string displacement_field(const std::filesystem::path& recording, double time);

}  // namespace rths::session
