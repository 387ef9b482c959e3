// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/core/config.hpp>

namespace rths {

/// Folder of the installed files, as maps and bearings: share/rths beside bin.   @setup
[[nodiscard]] std::filesystem::path shared_files();

/// Names of the installed files of a folder, as "maps", "diagrams", "bearings", "machines" and
/// "limits", sorted.   @setup
[[nodiscard]] std::vector<std::string> built_in_names(const std::string& folder);

/// Path of a built-in map by name ("srmd"), or the given path.
/// @throws Error if neither exists   @setup
[[nodiscard]] std::filesystem::path find_map(const std::string& name_or_path);

/// Path of a built-in bearing by name ("lprb"), or the given path.
/// @throws Error if neither exists   @setup
[[nodiscard]] std::filesystem::path find_bearing(const std::string& name_or_path);

/// Path of the file named by a config key: a path relative to the config file, or the bare name of
/// an installed file in `folder`, as in built_in_names.
/// @param otherwise  value if the key is absent; empty: the key is required
/// @throws Error with the place of the key if the file does not exist   @setup
[[nodiscard]] std::filesystem::path find_file(const Config& table, const std::string& key,
                                              const std::string& folder,
                                              const std::string& otherwise = "");

}  // namespace rths
