// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::experiment {

/// Start of the name that a term of the machine has in a model whose specimen uses its own name.
inline constexpr std::string_view kMachinePrefix = "machine_";

/// Terms that diagnoses have found, as changes to [specimen] and [machine] of an experiment.
struct Improvement {
  Config specimen, machine;
};

/// Reads the files that `improvement` of [model] lists; later ones override earlier ones.
/// @param text  improved.toml of another diagnosis, which overrides them; may be empty
/// @throws Error if a file has no term or an unknown key   @setup
[[nodiscard]] Improvement read_improvement(const Config& model, const std::string& text = "");

/// Files that the key `model.improvement` of an experiment lists, as full paths.
/// @throws Error if the experiment cannot be read, or a change is invalid
[[nodiscard]] std::vector<std::filesystem::path> improvements_of(
    const std::filesystem::path& experiment, const Overrides& changes);

/// Changes that add files to the improvements of an experiment, after those that it lists. Links
/// are followed.
/// @param files  improved.toml; relative paths start at the working folder
/// @throws Error as improvements_of
[[nodiscard]] Overrides improved_by(const std::vector<std::filesystem::path>& files,
                                    const std::filesystem::path& experiment, Overrides changes);

}  // namespace rths::experiment
