// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace rths {

/// Largest size of a configuration file, and of a table of numbers as text [B].
inline constexpr std::uint64_t kMostConfigBytes = 4U << 20U;
inline constexpr std::uint64_t kMostTextBytes = 1U << 30U;

/// Content of a file.
/// @throws Error if the path is not a regular file that can be read, or if the file is larger than
///         `most_bytes`   @setup
[[nodiscard]] std::string read_file(const std::filesystem::path& file, std::uint64_t most_bytes);

/// @throws Error if the path is not a regular file, such as a directory, a device or a pipe  @setup
void check_is_file(const std::filesystem::path& file);

/// Folder for temporary files: TMPDIR, otherwise /tmp.
/// @throws Error if there is no such folder   @setup
[[nodiscard]] std::filesystem::path temporary_folder();

/// The program of this name in the folders of PATH, as execvp searches it; none: there is none.
[[nodiscard]] std::optional<std::filesystem::path> found_in_path(const std::string& program);

}  // namespace rths
