// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <rths/launch/experiment.hpp>

namespace rths::launch {

/// Placeholders in the arguments of a script or program; replaced by values of the experiment.
inline constexpr std::string_view kMotionPlaceholder = "{motion}";  ///< path of a motion file
inline constexpr std::string_view kStepPlaceholder = "{step_s}";
inline constexpr std::string_view kDurationPlaceholder = "{duration_s}";
/// Of a program on the ring: names of the ring and of its node.
inline constexpr std::string_view kRingPlaceholder = "{ring}";
inline constexpr std::string_view kNodePlaceholder = "{node}";

/// Replaces the placeholders of an experiment in an argument. @param motion  path of its motion
/// file
[[nodiscard]] std::string filled_in(std::string argument, const Experiment& experiment,
                                    const std::filesystem::path& motion);
void replace_all(std::string& text, std::string_view from, const std::string& to);

/// Content of a motion file. Columns: time [s], accelerations long and lat [m/s²].
[[nodiscard]] std::string text_of(const sim::GroundMotion& motion);

}  // namespace rths::launch
