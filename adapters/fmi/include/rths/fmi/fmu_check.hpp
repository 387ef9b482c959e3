// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include <rths/adapters/finding.hpp>
#include <rths/core/config.hpp>

namespace rths::fmi {

/// Tries an FMU against the rules of a plugin, except for exports and abi. The first rule,
/// description, requires a modelDescription.xml, bindings and a binary that this project can use.
/// Inputs and outputs without a signal in `config` have signals of their own names.
/// @param config  table of a node; may be empty   @setup
[[nodiscard]] std::vector<adapters::Finding> check_fmu(const std::filesystem::path& file,
                                                       const Config& config);

/// Whether a path is that of an FMU: an .fmu file, or a folder with a modelDescription.xml.
[[nodiscard]] bool is_fmu(const std::filesystem::path& path);

}  // namespace rths::fmi
