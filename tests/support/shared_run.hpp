// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/files.hpp"
#include "support/long_run.hpp"

namespace rths::test {

/// A run of examples/srmd_lprb_2d.toml in virtual time with its diagnosis, which several tests
/// read. ctest makes it once as a fixture of these tests (tests/CMakeLists.txt).
struct SharedRun {
  /// Output folder. Tests must not write into it.
  std::filesystem::path path;
  /// Options of `rths run` that make the same run again.
  std::vector<std::string> options;

  [[nodiscard]] bool is_made() const { return std::filesystem::exists(path.string() + ".out"); }
  [[nodiscard]] std::string standard_output() const { return content_of(path.string() + ".out"); }
};

/// The first 10 s of the example, or all of it in long runs. Both diagnoses name the same causes.
inline SharedRun shared_run() {
  SharedRun run{build_tree() / "shared_run", {}};
  if (!is_long()) run.options = {"--set", "duration_s=10"};
  return run;
}

}  // namespace rths::test
