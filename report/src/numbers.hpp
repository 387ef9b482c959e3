// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "analysis.hpp"

namespace rths::report {

using Json = nlohmann::ordered_json;

inline constexpr double kPercent = 100;   ///< fraction to %
inline constexpr double kMilli = 1e3;     ///< s to ms, m to mm
inline constexpr double kPerKilo = 1e-3;  ///< N to kN

/// Every number of a report, in the units its keys name.
[[nodiscard]] Json numbers_of(const Analysis& analysis);
/// A report in a few lines for a terminal.
[[nodiscard]] std::string summary_of(const Analysis& analysis);
/// Returns true if no condition is broken.
[[nodiscard]] bool is_conclusive(const Analysis& analysis);

}  // namespace rths::report
