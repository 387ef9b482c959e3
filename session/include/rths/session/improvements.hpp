// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/launch/run.hpp>

namespace rths::session {

/// Files that the key `model.improvement` of an experiment lists, as full paths.
/// @throws Error if the experiment cannot be read, or a change is invalid
[[nodiscard]] std::vector<std::filesystem::path> improvements_of(
    const std::filesystem::path& experiment, const experiment::Overrides& changes);

/// Changes that add files to the improvements of an experiment, after those that it lists. Links
/// are followed.
/// @param files  improved.toml; relative paths start at the working folder
/// @throws Error as improvements_of
[[nodiscard]] experiment::Overrides improved_by(const std::vector<std::filesystem::path>& files,
                                                const std::filesystem::path& experiment,
                                                experiment::Overrides changes);

}  // namespace rths::session
