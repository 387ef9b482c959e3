// SPDX-License-Identifier: Apache-2.0
#include <rths/launch/run.hpp>

#include <sys/utsname.h>

#include <algorithm>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "run_modes.hpp"

namespace rths::launch {
recording::NamedTexts describe_run(const Experiment& experiment, ClockKind clock,
                                   const std::string& version) {
  utsname host{};
  uname(&host);
  const std::time_t now = std::time(nullptr);
  return {{"experiment", experiment.file.filename().string()},
          {"version", version},
          {"clock", clock == ClockKind::Wall ? "wall" : "virtual"},
          {"started", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now))},
          {"host", host.nodename},
          {"kernel", fmt::format("{} {} {}", host.sysname, host.release, host.machine)}};
}

Duration longest_stop(const Experiment& experiment) {
  constexpr double kMarginForPeers = 1.0;  // [s]
  return from_seconds(experiment.retreat.hold + experiment.retreat.ramp + kMarginForPeers);
}

namespace {

// Adds data that is available only after the run.
void add_to_meta(const std::filesystem::path& file, const Experiment& experiment,
                 const RunOutcome& outcome, const WallRunResult& result) {
  std::string privileges;
  for (const auto& line : result.privileges) privileges += (privileges.empty() ? "" : "; ") + line;
  const double test_time = experiment.duration * experiment.rate;
  recording::add_meta(file,
                      {{"processes", std::to_string(outcome.processes)},
                       {"wall_time_s", fmt::format("{:.3f}", outcome.wall_time)},
                       {"times_real_time", fmt::format("{:.1f}", test_time / outcome.wall_time)},
                       {"privileges", privileges.empty() ? "all" : privileges}});
  if (!result.lateness.largest.empty())
    recording::add_meta_series(file, "host_late", result.lateness.interval,
                               result.lateness.largest);
}

}  // namespace

void check_assembly(const Experiment& experiment) {
  static_cast<void>(assemble(experiment, ClockKind::Virtual, {}));
}

RunOutcome run(const Experiment& experiment, const RunOptions& options) {
  std::filesystem::create_directories(options.recording.parent_path());
  Assembly assembly =
      assemble(experiment, options.clock,
               {options.recording, describe_run(experiment, options.clock, options.version)});
  const WallClock clock;
  const TimePoint begun = clock.now();
  RunOutcome outcome;
  WallRunResult result;
  if (options.clock == ClockKind::Virtual) {
    result.trouble = run_in_virtual_time(experiment, assembly, options);
  } else {
    result = run_in_wall_time(experiment, assembly, options);
    outcome.processes = static_cast<int>(assembly.stations.size()) + 1;
  }
  outcome.trouble = result.trouble;
  outcome.interrupted = result.interrupted;
  outcome.completed = outcome.trouble.empty() && !outcome.interrupted;
  outcome.wall_time = to_seconds(clock.now() - begun);
  if (outcome.completed && std::filesystem::exists(options.recording)) {
    add_to_meta(options.recording, experiment, outcome, result);
    outcome.rows_missing = recording::Reader{options.recording}.rows_missing();
  }
  return outcome;
}

}  // namespace rths::launch
