// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace rths {

/// Largest number of parts of a key, and of arrays and tables inside each other.
inline constexpr std::size_t kDeepest = 32;

/// The line, counted from 1, at which TOML text is nested deeper; 0 if nowhere. Reading and freeing
/// such text would overflow the stack.
[[nodiscard]] std::size_t line_too_deep(std::string_view text) noexcept;

}  // namespace rths
