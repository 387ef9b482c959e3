// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "analysis.hpp"

namespace rths::report {

using Json = nlohmann::ordered_json;

/// Every number of a report, in the units its keys name.
[[nodiscard]] Json numbers_of(const Analysis& analysis);
/// The same in a few lines for a terminal.
[[nodiscard]] std::string summary_of(const Analysis& analysis);
/// True if the host was in time often enough for real-time claims: at most 1 % of steps excused.
[[nodiscard]] bool is_conclusive(const Analysis& analysis);

}  // namespace rths::report
