// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace rths::launch {

/// What stands for something of the experiment in the arguments of a script.
inline constexpr std::string_view kMotionPlace = "{motion}";  ///< a file of the ground motion
inline constexpr std::string_view kStepPlace = "{step_s}", kDurationPlace = "{duration_s}";

}  // namespace rths::launch
