// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "trial_case.hpp"

namespace trial {

/// Writes the input of a diagnosis: case.toml and three recordings.
void write_case_folder(const TrialCase& trial, const std::filesystem::path& folder);

}  // namespace trial
