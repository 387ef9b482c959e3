// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "trial_case.hpp"

namespace trial {

/// Writes all that a diagnosis may see: case.toml and three recordings.
void write_case_folder(const TrialCase& trial, const std::filesystem::path& folder);

}  // namespace trial
