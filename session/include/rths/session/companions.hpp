// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <rths/experiment/experiment.hpp>

namespace rths::session {

using experiment::Experiment;

/// Repeats the displacement history of a run in virtual time without compensation, to measure the
/// delay of the machine. Returns false if the experiment has no [uncompensated], or if a node
/// other than the solver is a program of the user's own.
/// @param history  recording of the run whose targets are imposed   @throws Error   @setup
bool run_uncompensated(const Experiment& experiment, const std::filesystem::path& history,
                       const std::filesystem::path& recording, const std::string& version);

/// Repeats the test under the second earthquake in virtual time, with independent noise. The
/// diagnosis proves its verdict on this recording. Returns false if the experiment has no
/// [held_out], or a node that is a program of the user's own.
/// @throws Error   @setup
bool run_held_out(const Experiment& experiment, const std::filesystem::path& recording,
                  const std::string& version);

/// Writes the purely numerical result as a recording: [reference], or the response with a model in
/// place of the specimen. A structure of the project's own is also analysed on a fixed base. A
/// solver that has its own runs again, with an ideal machine. Returns false if the structure of a
/// user's own solver is not stated in [plant].
/// @throws Error   @setup
bool run_numerical(const Experiment& experiment, const std::filesystem::path& recording,
                   const std::string& version);

}  // namespace rths::session
