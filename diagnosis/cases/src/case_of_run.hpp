// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/cases/case.hpp>
#include <rths/core/config.hpp>

namespace rths::diagnosis {

/// Makes a case of the recording of a run: its measurements, the model of its simulation, and the
/// recording of a second earthquake in the same folder.
/// @throws Error if the recording contains no model or lacks a signal   @setup
[[nodiscard]] Case case_of_run(const std::filesystem::path& file);

/// Reads a [model] table. @throws Error with the position of the first wrong key or value   @setup
[[nodiscard]] Model read_model(const Config& table);

}  // namespace rths::diagnosis
