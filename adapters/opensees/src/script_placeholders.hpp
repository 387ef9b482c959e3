// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace rths::adapters {

/// Placeholders in the arguments of a script; replaced by values of the experiment.
inline constexpr std::string_view kMotionPlaceholder = "{motion}";  ///< path of a motion file
inline constexpr std::string_view kStepPlaceholder = "{step_s}";
inline constexpr std::string_view kDurationPlaceholder = "{duration_s}";

}  // namespace rths::adapters
