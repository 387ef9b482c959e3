// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/config.hpp>

namespace rths {

/// The whole file. @throws Error if it cannot be read
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// Reads TOML text into our own values; the only place that knows the TOML library.
/// @throws Error "name:line:column: …"
[[nodiscard]] ConfigValue::Table parse_toml(std::string_view text, const std::string& name);

/// The inverse: text that `parse_toml` reads back.
[[nodiscard]] std::string write_toml(const ConfigValue::Table& table);

}  // namespace rths
