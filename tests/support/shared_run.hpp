// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/process.hpp"

namespace rths::test {

/// The example that the shared runs simulate, in examples/.
inline constexpr const char* kSharedExample = "srmd_lprb_2d.toml";
/// Options of `rths run` for the short run. Its diagnosis names the same causes as the whole
/// example's.
inline const std::vector<std::string> kShortRun{"--set", "duration_s=10"};

/// A run of the example that several tests read. One test makes it; the others require it as a
/// ctest fixture (tests/properties.cmake).
class SharedRun {
 public:
  explicit SharedRun(const std::string& name);

  /// Runs the example in virtual time and replaces the run of an earlier ctest call.
  [[nodiscard]] Finished make(const std::vector<std::string>& options = {}) const;
  [[nodiscard]] bool is_made() const;

  /// The run's output folder. Tests must not write into it.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The run's standard output.
  [[nodiscard]] std::string standard_output() const;

 private:
  std::filesystem::path path_, standard_output_;
};

}  // namespace rths::test
