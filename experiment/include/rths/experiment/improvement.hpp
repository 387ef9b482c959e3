// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <rths/core/config.hpp>

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

}  // namespace rths::experiment
