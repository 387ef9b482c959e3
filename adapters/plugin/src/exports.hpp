// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rths::plugin {

/// Functions and objects that a shared library exports, sorted.
/// @throws Error if it is not an ELF library of 64 bits   @setup
[[nodiscard]] std::vector<std::string> exported_symbols(const std::filesystem::path& library);

}  // namespace rths::plugin
