// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/files.hpp"

namespace rths::test {

/// A run of examples/srmd_lprb_2d.toml in virtual time that several tests read. ctest makes it once
/// as a fixture of these tests (tests/CMakeLists.txt).
struct SharedRun {
  /// Output folder. Tests must not write into it.
  std::filesystem::path path;
  /// Options of `rths run` that make the same run again.
  std::vector<std::string> options;

  [[nodiscard]] bool is_made() const { return std::filesystem::exists(path.string() + ".out"); }
  [[nodiscard]] std::string standard_output() const { return content_of(path.string() + ".out"); }
};

/// The unchanged example.
inline SharedRun example_run() { return {build_tree() / "shared_runs/example", {}}; }

/// The first 10 s of the example. Its diagnosis names the same causes.
inline SharedRun short_run() {
  return {build_tree() / "shared_runs/short", {"--set", "duration_s=10"}};
}

}  // namespace rths::test
