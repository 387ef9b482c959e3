// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <rths/launch/experiment.hpp>

namespace rths::launch {

/// How far a run is, for whoever watches.
struct Progress {
  double model_time = 0;  ///< [s]
  double duration = 0;    ///< [s]
};

struct RunOptions {
  ClockKind clock = ClockKind::Wall;
  std::filesystem::path recording;  ///< file to write
  std::string ring;                 ///< name of the ring in shared memory; wall clock only
  Overrides overrides;              ///< the experiment was loaded with: its processes need them too
  std::string version;              ///< of the program, for the recording
  std::function<void(const Progress&)> progress;  ///< called a few times a second; may be empty
};

/// How a run ended.
struct RunOutcome {
  bool completed = false;    ///< to its end, every node at rest and gone
  bool interrupted = false;  ///< by a person
  std::string trouble;       ///< one line, if it was not completed
  double wall_time = 0;      ///< [s]
  int processes = 1;
};

/// Runs an experiment to its end or to the first fault and brings everything to rest.
/// @throws Error if it cannot be started   @setup
[[nodiscard]] RunOutcome run(const Experiment& experiment, const RunOptions& options);

/// Builds everything an experiment needs, and lets it go again: what can only go wrong then does so
/// now. @throws Error   @setup
void check_assembly(const Experiment& experiment);

/// The same displacement history again, in virtual time, with all compensation off: what the delay
/// of the machine is measured on. Returns false if the experiment does not say how to switch off.
/// @param history  recording of the run whose targets are played   @throws Error   @setup
bool run_uncompensated(const Experiment& experiment, const std::filesystem::path& history,
                       const std::filesystem::path& recording, const std::string& version);

/// The same test again under the second earthquake, in virtual time and with noise of its own: what
/// the diagnosis proves its answer on. Returns false if the experiment names none.
/// @throws Error   @setup
bool run_held_out(const Experiment& experiment, const std::filesystem::path& recording,
                  const std::string& version);

/// The purely numerical result, with a model in the specimen's place, and the plant on a fixed
/// base; written as a recording.   @throws Error   @setup
void run_numerical(const Experiment& experiment, const std::filesystem::path& recording);

/// One node of a run, in a process of its own; the launcher talks to it on standard input.
/// @returns exit code of the process   @setup
[[nodiscard]] int run_node(const Experiment& experiment, const std::string& node,
                           const std::string& ring, const std::filesystem::path& recording,
                           const std::string& version);

}  // namespace rths::launch
