// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include <rths/adapters/factory.hpp>
#include <rths/launch/experiment.hpp>

namespace rths::app {

/// All adapters that an experiment can name.
[[nodiscard]] std::span<const adapters::Factory> builtin_adapters();

/// Loads an experiment whose nodes have these adapters.
/// @throws Error file:line:column of the first fault   @setup
[[nodiscard]] inline launch::Experiment load_experiment(const std::filesystem::path& file,
                                                        const launch::Overrides& overrides = {}) {
  return launch::load_experiment(builtin_adapters(), file, overrides);
}

}  // namespace rths::app
