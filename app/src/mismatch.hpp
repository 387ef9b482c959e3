// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/launch/run.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::app {

/// Adds the mismatch budget of a run and the improved simulation as an experiment to its verdict,
/// or a limit that says why there is none.
/// @param recording  run.h5; a held-out record lies beside it
/// @param changes  of the run to its experiment
/// @param folder  of the results; the improved model of the verdict is written there
void add_mismatch_budget(const std::filesystem::path& recording,
                         const std::filesystem::path& experiment,
                         const experiment::Overrides& changes, const std::filesystem::path& folder,
                         diagnosis::Verdict& verdict);

/// The same with the experiment that the recording names. Does nothing if its file is gone.
void add_mismatch_budget(const std::filesystem::path& recording,
                         const std::filesystem::path& folder, diagnosis::Verdict& verdict);

}  // namespace rths::app
