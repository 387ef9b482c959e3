// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace rths {

using KeyValue = std::pair<std::string, std::string>;

/// The parts of "key=value"; empty if the text has no key or no '='.
[[nodiscard]] inline std::optional<KeyValue> key_value(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return std::nullopt;
  return KeyValue{text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace rths
