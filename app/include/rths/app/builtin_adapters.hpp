// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include <rths/experiment/node.hpp>
#include <rths/launch/run.hpp>

namespace rths::app {

/// All adapters that an experiment can name. A machine has the safety layer in front of it: srmd
/// unless its table `safety` says `enabled = false`, a plugin or an FMU if its table has `safety`.
[[nodiscard]] std::span<const experiment::AdapterKind> builtin_adapters();

/// Loads an experiment whose nodes have these adapters.
/// @throws Error file:line:column of the first fault   @setup
[[nodiscard]] inline experiment::Experiment load_experiment(
    const std::filesystem::path& file, const experiment::Overrides& overrides = {}) {
  return experiment::load_experiment(builtin_adapters(), file, overrides);
}

}  // namespace rths::app
