// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/cases/case.hpp>

namespace rths::diagnosis {

/// Samples of all moving records of a case that are used at most: a diagnosis then takes minutes.
/// Of a bearing, platen or axis, steps of the model count, at most 500 each second.
inline constexpr double kMostSamples = 100'000;

/// Reduces the moving records of a case to the budget. A record of a free-running model that is
/// sampled far above the frequencies of its channels passes a low-pass filter and is thinned. What
/// is still too long loses its end.
/// @returns what was lost, for the limits of a verdict   @setup
[[nodiscard]] std::vector<std::string> bound_records(Case& c);

}  // namespace rths::diagnosis
