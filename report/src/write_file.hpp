// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <rths/core/error.hpp>

namespace rths::report {

/// @throws Error if the file cannot be written
inline void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream{file, std::ios::binary};
  stream << text;
  stream.close();
  if (!stream) throw Error{file.string() + ": cannot be written"};
}

}  // namespace rths::report
