// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/experiment/experiment.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::session {

/// Carries the intervals of the found parameters to the response of the improved simulation of a
/// run. Nothing is added if nothing of the specimen was named, or if the simulation is not one of
/// the project's own structure.
/// @throws Error if the experiment cannot be read, or a simulation diverges
void add_response_bands(const std::filesystem::path& experiment,
                        const experiment::Overrides& changes, diagnosis::Verdict& verdict);

}  // namespace rths::session
