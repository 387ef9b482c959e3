// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include <rths/core/error.hpp>

namespace rths::recording {

/// Calls `write` with a temporary path beside `file`, then renames it. If that fails, the file is
/// unchanged.
/// @throws Error "<file>: <reason>"
template <class Write>
void replace_file(const std::filesystem::path& file, const char* ending, Write write) {
  auto temporary = file;
  temporary += ending;
  try {
    write(temporary);
    std::filesystem::rename(temporary, file);
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error{file.string() + ": " + error.what()};
  }
}

}  // namespace rths::recording
