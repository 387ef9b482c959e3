// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::session {

/// Adds the mismatch budget of a run and the improved simulation as an experiment to its verdict,
/// or a limit that says why there is none.
/// @param recording  run.h5; a held-out record lies beside it
/// @param changes  of the run to its experiment
void add_mismatch_budget(const std::filesystem::path& recording,
                         const std::filesystem::path& experiment,
                         const experiment::Overrides& changes, diagnosis::Verdict& verdict);

/// The same with the experiment that the recording names. Does nothing if its file is gone.
void add_mismatch_budget(const std::filesystem::path& recording, diagnosis::Verdict& verdict);

/// Why the experiment of a run cannot be repeated: its file is missing or has changed. Empty: it
/// can.   @setup
[[nodiscard]] std::string change_since(const recording::Reader& run,
                                       const std::filesystem::path& experiment);

}  // namespace rths::session
