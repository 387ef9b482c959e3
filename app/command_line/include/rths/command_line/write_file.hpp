// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include <rths/core/error.hpp>
#include <rths/core/replace_files.hpp>
#include <rths/recording/recording.hpp>

namespace rths::app {

/// @throws Error if results may not be written to the path: the file is a recording, or read-only
inline void check_target(const std::filesystem::path& file) {
  if (file.empty()) throw Error{"the file for the results has no name"};
  if (access(file.c_str(), F_OK) != 0) return;
  if (access(file.c_str(), W_OK) != 0) throw Error{file.string() + ": cannot be written"};
  if (recording::is_hdf5(file))
    throw Error{file.string() + ": is a recording, expected another file for the results"};
}

/// For results that a long measurement writes at its end.
/// @throws Error as `check_target`, or if the path is a folder, a device or a pipe. A pipe that no
/// program reads would keep the command waiting.
inline void check_result_file(const std::filesystem::path& file) {
  check_target(file);
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    throw Error{file.string() + ": is no regular file, expected one for the results"};
}

/// A file is replaced when the new one is complete; a device or a pipe is written directly.
/// @throws Error if the file is a recording or cannot be written; it is unchanged then
inline void write_file(const std::filesystem::path& file, const std::string& content) {
  check_target(file);
  std::error_code error;
  const bool is_there = std::filesystem::exists(file, error);
  const auto target = is_there ? std::filesystem::canonical(file, error) : file;
  if (!is_there || std::filesystem::is_regular_file(target, error))
    return replace_file(target, content);
  std::ofstream stream{target, std::ios::binary};
  stream << content;
  stream.close();
  if (!stream) throw Error{file.string() + ": cannot be written"};
}

}  // namespace rths::app
