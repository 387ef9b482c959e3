// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace rths::plugin {

/// What to load for the plugin of a user: his library itself, or for a file in Python the host of
/// such files.
struct PluginFile {
  std::filesystem::path library;
  std::string config;  ///< TOML text, for the library
  std::string title;   ///< for messages; empty: that of the library
  bool is_python = false;
};

/// @param file    a shared library, or a file that ends with .py
/// @param config  of the user, TOML text
/// @throws Error if this installation has no Python   @setup
[[nodiscard]] PluginFile plugin_file(const std::filesystem::path& file, const std::string& config);

}  // namespace rths::plugin
