// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::experiment {

/// Placeholders in the arguments of a user's script or program; replaced by values of the test.
inline constexpr std::string_view kMotionPlaceholder = "{motion}";  ///< path of a motion file
inline constexpr std::string_view kStepPlaceholder = "{step_s}";
inline constexpr std::string_view kDurationPlaceholder = "{duration_s}";
/// Of a script: path of the recording without its ending, which differs between the runs of a test.
inline constexpr std::string_view kResultsPlaceholder = "{results}";
/// Of a program on the ring: names of the ring and of its node.
inline constexpr std::string_view kRingPlaceholder = "{ring}";
inline constexpr std::string_view kNodePlaceholder = "{node}";

/// Checks the placeholders in the arguments of a key.
/// @throws Error with the place of the key for an unknown one   @setup
void check_placeholders(const Config& table, const std::string& key,
                        const std::vector<std::string>& arguments,
                        const std::vector<std::string_view>& known);
/// Replaces the placeholders of the test in an argument.
/// @param motion  path of its motion file   @returns whether the argument names that file
bool fill_in(std::string& argument, const Experiment& experiment,
             const std::filesystem::path& motion);

/// Content of a motion file. Columns: time [s], accelerations long and lat [m/s²].
[[nodiscard]] std::string motion_text(const sim::GroundMotion& motion);
/// File of a node beside the recording of the run: "run.opf.log".
[[nodiscard]] std::filesystem::path file_beside(const std::filesystem::path& recording,
                                                const std::string& node, const std::string& ending);
/// True if a program can be run: a path, or a name that is searched in PATH.   @setup
[[nodiscard]] bool is_program(const std::string& name);

}  // namespace rths::experiment
