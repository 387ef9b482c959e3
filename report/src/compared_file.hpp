// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rths::report {

/// A signal of a file, in SI.
struct FileSignal {
  std::string unit;  ///< SI; empty: not stated
  std::vector<double> values;
};

/// What a comparison reads from a recording or from a table.
struct ComparedFile {
  std::vector<double> time;  ///< rising [s]
  std::map<std::string, FileSignal> signals;
  std::map<std::string, std::string> settings;  ///< of the experiment, by dotted key; texts by name
  bool has_experiment = false;                  ///< its settings are complete
  std::map<std::string, std::string> roles;     ///< name of the signal of each role
};

/// @throws Error if it cannot be read, or has no column of time   @setup
[[nodiscard]] ComparedFile read_compared(const std::filesystem::path& file);

}  // namespace rths::report
