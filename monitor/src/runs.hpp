// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace rths::monitor {

/// The results below a folder, newest first, as one JSON list. A run without a report, or with a
/// damaged one, says so.
[[nodiscard]] std::string runs_in(const std::filesystem::path& folder);

/// A file or folder below a folder; empty if there is none of this name, or it lies outside.
/// @param relative  as in a URL
[[nodiscard]] std::optional<std::filesystem::path> below(const std::filesystem::path& folder,
                                                         const std::string& relative);

}  // namespace rths::monitor
