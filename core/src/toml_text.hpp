// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/config.hpp>

namespace rths {

/// Reads TOML text. Only toml_text.cpp uses the TOML library.
/// @throws Error "name:line:column: …"
[[nodiscard]] ConfigValue::Table parse_toml(std::string_view text, const std::string& name);

/// Writes TOML text that `parse_toml` reads back.
[[nodiscard]] std::string write_toml(const ConfigValue::Table& table);

}  // namespace rths
