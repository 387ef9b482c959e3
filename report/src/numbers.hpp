// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <rths/verdict/verdict.hpp>

#include "analysis.hpp"

namespace rths::report {

using Json = nlohmann::ordered_json;

inline constexpr double kPercent = 100;   ///< fraction to %
inline constexpr double kMilli = 1e3;     ///< s to ms, m to mm
inline constexpr double kPerKilo = 1e-3;  ///< N to kN
inline constexpr double kPerMega = 1e-6;  ///< N to MN

/// A JSON list of converted items.
template <class Items, class Make>
Json each(const Items& items, Make make) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(make(item));
  return list;
}

inline Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

/// Every number of a report, in the units its keys name.
[[nodiscard]] Json numbers_of(const Analysis& analysis);
/// The contents of verdict.json.
[[nodiscard]] Json verdict_numbers(const diagnosis::Verdict& verdict);
/// A report in a few lines for a terminal.
[[nodiscard]] std::string summary_of(const Analysis& analysis);
/// Returns true if no condition is broken.
[[nodiscard]] bool is_conclusive(const Analysis& analysis);

}  // namespace rths::report
