// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/core/config.hpp>
#include <rths/diagnosis/case.hpp>

namespace rths::diagnosis {

/// The case that a recording of our own is: what it recorded of the machine, what the simulation
/// assumed, and the recordings beside it that belong to it.
/// @throws Error if it does not say what the simulation assumed, or lacks a signal   @setup
[[nodiscard]] Case case_of_run(const std::filesystem::path& file);

/// Reads a [model] table. @throws Error with the place of the first wrong key or value   @setup
[[nodiscard]] Model read_model(const Config& table);

}  // namespace rths::diagnosis
