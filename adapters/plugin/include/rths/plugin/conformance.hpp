// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths_adapter.h>

#include <rths/adapters/finding.hpp>

namespace rths::plugin {

using adapters::Finding;

struct ConformanceSettings {
  const rths_adapter* built_in = nullptr;  ///< of this program; the rule exports is not tried
  std::string config;                      ///< TOML text, for the plugin
  bool may_allocate = false;  ///< a step may use the heap: the rule allocation is not tried
  double period = 1e-3;       ///< of the steps [s]
  double step_deadline = 2;   ///< of a call, if it uses the processor [s]; else five times that
};

/// Tries a plugin against all rules: exports, abi, lifecycle, signals, units, range, nan, bounds,
/// deadline, allocation, stop, restart, instances, determinism, crash. The plugin runs in child
/// processes, so it cannot harm this one. Findings are in this order.
/// @throws Error if the file cannot be read   @setup
[[nodiscard]] std::vector<Finding> check_plugin(const std::filesystem::path& library,
                                                const ConformanceSettings& settings);

/// Whether a file is a shared library or another ELF file.
[[nodiscard]] bool is_library(const std::filesystem::path& file);

}  // namespace rths::plugin
