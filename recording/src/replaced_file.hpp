// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>

namespace rths::recording {

/// An ending for a temporary file beside `file` that no other file has.
inline std::string unused_ending(const std::filesystem::path& file) {
  std::string ending = ".part";
  for (int i = 2; std::filesystem::exists(file.string() + ending); ++i)
    ending = ".part" + std::to_string(i);
  return ending;
}

/// Waits until the disk has a file, so that a power failure after a renaming does not lose both.
inline void write_through(const std::filesystem::path& file) {
  const int descriptor =
      open(file.c_str(), O_RDONLY | O_CLOEXEC);  // NOLINT(cppcoreguidelines-pro-type-vararg)
  const bool is_written = descriptor >= 0 && fsync(descriptor) == 0;
  const int problem = errno;
  if (descriptor >= 0) close(descriptor);
  if (!is_written) throw Error{std::strerror(problem)};
}

/// Calls `write` with a temporary path, `file` with an ending, then renames it. If that fails or is
/// interrupted, the file is unchanged. Of a link, the file that it leads to is replaced.
/// @throws Error "<file>: <reason>"
template <class Write>
void replace_file(const std::filesystem::path& file, const std::string& ending, Write write) {
  std::error_code is_new;
  const auto there = std::filesystem::canonical(file, is_new);
  const auto target = is_new ? file : there;
  auto temporary = target;
  temporary += ending;
  try {
    write(temporary);
    std::filesystem::rename(temporary, target);
  } catch (const Interrupted&) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error{file.string() + ": " + error.what()};
  }
}

}  // namespace rths::recording
