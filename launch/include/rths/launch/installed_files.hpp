// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <rths/core/config.hpp>

namespace rths::launch {

/// Folder of the maps and diagrams that come with the command: share/rths beside its bin.   @setup
[[nodiscard]] std::filesystem::path shared_files();

/// A built-in map by name ("srmd"), or the path itself if it names a file.
/// @throws Error if there is neither   @setup
[[nodiscard]] std::filesystem::path find_map(const std::string& name_or_path);

/// A bearing that comes along by name ("lprb"), or the path itself if it names a file.
/// @throws Error if there is neither   @setup
[[nodiscard]] std::filesystem::path find_bearing(const std::string& name_or_path);

/// File that a config key names: a path relative to the config, or a bare name of an installed file
/// in `folder` ("maps", "diagrams", "bearings"); `otherwise` if the key is absent and it is given.
/// @throws Error with the key's place if there is neither   @setup
[[nodiscard]] std::filesystem::path find_file(const Config& table, const std::string& key,
                                              const std::string& folder,
                                              const std::string& otherwise = "");

}  // namespace rths::launch
