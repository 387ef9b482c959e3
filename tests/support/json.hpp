// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <nlohmann/json.hpp>

#include "support/files.hpp"

namespace rths::test {

/// Content of a JSON file.
[[nodiscard]] inline nlohmann::json json_of(const std::filesystem::path& file) {
  return nlohmann::json::parse(content_of(file));
}

/// Whether the run of a report.json broke a condition of a conclusive test.
[[nodiscard]] inline bool breaks(const nlohmann::json& report, std::string_view condition) {
  const auto& broken = report.at("broken");
  return std::any_of(broken.begin(), broken.end(),
                     [&](const auto& one) { return one.at("condition") == condition; });
}

}  // namespace rths::test
