// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <rths/experiment/experiment.hpp>

namespace rths::launch {

/// Gives the calling thread real-time scheduling, locked memory and exact timers. Nothing else
/// does so. A missing privilege is not an error.
/// @param priority  1…99
/// @returns the missing privileges as text; empty if none   @setup
[[nodiscard]] std::string make_realtime(int priority);

/// Real-time privileges that this user lacks, as text; empty if none.   @setup
[[nodiscard]] std::string missing_privileges();

using experiment::Experiment;
using experiment::NodePlan;
using experiment::Overrides;
using experiment::Tuning;

enum class ClockKind { Wall, Virtual };

/// Progress of a run.
struct Progress {
  double model_time = 0;  ///< [s]
  double duration = 0;    ///< [s]
};

struct RunOptions {
  ClockKind clock = ClockKind::Wall;
  std::filesystem::path recording;  ///< file to write
  std::string ring;                 ///< name of the ring in shared memory
  std::string host;                 ///< this host of a test on several; empty: all nodes run here
  std::string interface;            ///< of the network; empty: the experiment's
  Overrides overrides;              ///< those of load_experiment; passed on to the processes
  std::string version;              ///< of the program, for the recording
  /// Called when all nodes are ready, before the first step. If it throws, the run is not started.
  std::function<void()> started;
  std::function<void(const Progress&)> progress;   ///< called a few times per second; may be empty
  std::function<void(const std::string&)> report;  ///< a line per event of the network, any thread
  /// In virtual time on one host: how late a step of a node starts that is due at a time. The
  /// recording then holds the times of all steps, as in real time. Empty: never.
  std::function<Duration(const std::string& node, Duration due)> lateness;
};

/// Result of a run.
struct RunOutcome {
  bool completed = false;         ///< ended in order; all nodes came to rest and left
  bool stopped_early = false;     ///< in order, but by request before the planned end
  bool interrupted = false;       ///< by a person
  std::string trouble;            ///< one line; empty if completed
  bool has_ring_faults = false;   ///< of the cards of a replicated ring
  double wall_time = 0;           ///< [s]
  std::int64_t rows_missing = 0;  ///< of the recording of a completed run
  /// One line per word of this host that another process than its owner has stored.
  std::vector<std::string> foreign_stores;
};

/// Runs an experiment to its end or to the first fault and brings everything to rest.
/// @throws Error if it cannot be started   @setup
[[nodiscard]] RunOutcome run(const Experiment& experiment, const RunOptions& options);

/// Asks the run on a ring of this host to end in order, as at the end of its duration.
/// @returns process id of its launcher   @throws Error if there is none   @setup
int request_stop(const std::string& ring);

/// Builds everything an experiment needs and discards it, to find errors that loading cannot find.
/// @throws Error   @setup
void check_assembly(const Experiment& experiment);

/// Text of /meta: how a companion run differs from its test. Absent: the run is no companion.
inline constexpr const char* kCompanion = "companion";

/// Series of /meta: start of each scheduled step of a node after its scheduled time, and duration
/// of the step [s]. The name of the node follows.
inline constexpr const char* kLateSeries = "late.";
inline constexpr const char* kDurationSeries = "duration.";

/// Runs one node in its own process; the launcher controls it through standard input.
/// @returns exit code of the process   @setup
[[nodiscard]] int run_node(const Experiment& experiment, const std::string& node,
                           const std::string& ring, const std::filesystem::path& recording,
                           const std::string& version);

}  // namespace rths::launch
