// SPDX-License-Identifier: Apache-2.0
#include <rths/launch/run.hpp>

#include <sys/utsname.h>

#include <algorithm>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "run_parts.hpp"

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

namespace {

void add_to_meta(const std::filesystem::path& file, const WallRunResult& result, int processes) {
  std::string privileges;
  for (const auto& line : result.privileges) privileges += (privileges.empty() ? "" : "; ") + line;
  recording::add_meta(file, {{"processes", std::to_string(processes)},
                             {"privileges", privileges.empty() ? "all" : privileges}});
  recording::add_meta_series(file, "host_late", result.lateness.interval, result.lateness.largest);
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
  if (options.clock == ClockKind::Virtual) {
    outcome.trouble = run_in_virtual_time(experiment, assembly, options);
  } else {
    const WallRunResult result = run_in_wall_time(experiment, assembly, options);
    outcome.trouble = result.trouble;
    outcome.interrupted = result.interrupted;
    outcome.processes = static_cast<int>(assembly.stations.size()) + 1;
    if (outcome.trouble.empty()) add_to_meta(options.recording, result, outcome.processes);
  }
  outcome.completed = outcome.trouble.empty() && !outcome.interrupted;
  outcome.wall_time = to_seconds(clock.now() - begun);
  return outcome;
}

}  // namespace rths::launch
