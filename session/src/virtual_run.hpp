// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <rths/launch/run.hpp>

namespace rths::session {

/// Runs an experiment in virtual time, without a progress.
inline launch::RunOutcome run_virtually(const experiment::Experiment& experiment,
                                        const std::filesystem::path& recording,
                                        const std::string& version) {
  launch::RunOptions options;
  options.clock = launch::ClockKind::Virtual;
  options.recording = recording;
  options.version = version;
  return launch::run(experiment, options);
}

/// Gives repetition k of an experiment noise and computing times of its own; 0: the experiment's.
inline void renew_noise(experiment::Experiment& experiment, std::uint64_t k) {
  constexpr std::uint64_t kSeedOffset = 1'000'003;  // beyond the small seeds of experiments
  experiment.machine.simulated.seed += k * kSeedOffset;
  experiment.solver.computing_time.seed += k * kSeedOffset;
}

}  // namespace rths::session
