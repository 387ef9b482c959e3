// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace rths::session
