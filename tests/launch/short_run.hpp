// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiment_keys.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::launch {

/// A short run of an experiment in virtual time, in a folder of its own.
class ShortRun {
 public:
  /// @param sets  changes of the experiment; a later one replaces an earlier one of its key
  ShortRun(const std::filesystem::path& experiment, const std::vector<Set>& sets);

  /// Whether the test has begun: one of two seconds is often not conclusive.
  [[nodiscard]] bool has_run() const;
  [[nodiscard]] const test::Finished& finished() const { return finished_; }
  /// Whether `rths check` accepts the same experiment without a remark.
  [[nodiscard]] bool is_accepted_by_check() const;
  /// The same signals and the same numbers of the report.
  [[nodiscard]] bool has_same_results(const ShortRun& other) const;

 private:
  [[nodiscard]] std::filesystem::path at(const std::string& file) const;
  [[nodiscard]] bool has_same_signals(const ShortRun& other, const std::string& file) const;
  [[nodiscard]] nlohmann::json numbers() const;

  std::vector<std::string> experiment_;  ///< with its changes, as words of a command
  test::TemporaryFolder folder_;
  test::Finished finished_;
};

}  // namespace rths::launch
