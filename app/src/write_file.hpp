// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <rths/core/error.hpp>

namespace rths::app {

/// @throws Error if the file cannot be written
inline void write_file(const std::filesystem::path& file, const std::string& content) {
  std::ofstream stream{file, std::ios::binary};
  stream << content << std::flush;
  if (!stream) throw Error{file.string() + ": cannot be written"};
}

}  // namespace rths::app
