// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "support/files.hpp"

namespace rths::test {

/// Content of a JSON file.
[[nodiscard]] inline nlohmann::json json_of(const std::filesystem::path& file) {
  return nlohmann::json::parse(content_of(file));
}

}  // namespace rths::test
