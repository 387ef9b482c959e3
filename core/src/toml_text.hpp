// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include <rths/core/config.hpp>

namespace rths {

/// Largest number of parts of a key, and of arrays and tables inside each other.
inline constexpr std::size_t kDeepest = 32;

/// The line, counted from 1, at which TOML text is nested deeper; 0 if nowhere. Reading and freeing
/// such text would overflow the stack.
[[nodiscard]] std::size_t line_too_deep(std::string_view text) noexcept;

/// Reads TOML text. Only toml_text.cpp uses the TOML library.
/// @throws Error "name:line:column: …"
[[nodiscard]] ConfigValue::Table parse_toml(std::string_view text, const std::string& name);

/// Writes TOML text that `parse_toml` reads back.
[[nodiscard]] std::string write_toml(const ConfigValue::Table& table);

}  // namespace rths
