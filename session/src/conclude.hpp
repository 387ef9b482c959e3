// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/session/run.hpp>

namespace rths::session {

/// An uncompressed recording is complete, so a failure is only noted.
void compress(const std::filesystem::path& recording, const Progress& progress);

/// Judges the recording of a completed test, computes its companions and its diagnosis, and
/// reports. Of a test with commanded displacements there is no response to judge.
/// @throws Error if the recording is gone, or as report::make_report
void conclude(const RunSettings& settings, const experiment::Experiment& experiment,
              const Progress& progress, RunResult& result);

/// Reports on a test that the safety layer or a fault of the ring has ended.
void report_end(RunResult& result);

}  // namespace rths::session
