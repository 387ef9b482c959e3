// SPDX-License-Identifier: Apache-2.0
#include "support/opensees.hpp"

#include <cstdlib>
#include <filesystem>

#include "support/files.hpp"

namespace rths::test {

std::optional<std::string> opensees_python() {
  if (const char* named = std::getenv("RTHS_OPENSEES_PYTHON")) return named;
  const auto made = source_tree() / "build/opensees/bin/python";
  if (std::filesystem::exists(made)) return made.string();
  return std::nullopt;
}

bool has_mpich() { return std::filesystem::exists("/usr/bin/mpiexec.mpich"); }

}  // namespace rths::test
