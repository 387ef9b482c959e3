// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace rths::app {

/// Python of the command line, else of the environment, else of the build folder; empty: none.
inline std::string opensees_python(const std::string& requested,
                                   const std::filesystem::path& programs) {
  if (!requested.empty()) return requested;
  if (const char* python = std::getenv("RTHS_OPENSEES_PYTHON")) return python;
  const std::filesystem::path installed = programs / "../../opensees/bin/python";
  return std::filesystem::exists(installed) ? installed.lexically_normal().string() : "";
}

}  // namespace rths::app
