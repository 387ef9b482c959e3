// SPDX-License-Identifier: Apache-2.0
#include <rths/launch/run.hpp>

#include <sys/utsname.h>
#include <unistd.h>

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
  const std::size_t processes = clock == ClockKind::Wall ? experiment.nodes.size() + 1 : 1;
  recording::NamedTexts meta{
      {"experiment", experiment.file.filename().string()},
      {"experiment_path", experiment.file.string()},
      {"version", version},
      {"clock", clock == ClockKind::Wall ? "wall" : "virtual"},
      {"processes", std::to_string(processes)},
      {"started", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now))},
      {"host", host.nodename},
      {"kernel", fmt::format("{} {} {}", host.sysname, host.release, host.machine)}};
  if (!experiment.companion.empty()) meta.emplace_back(kCompanion, experiment.companion);
  if (const auto machine = experiment.unguarded_machine())
    meta.emplace_back("without_safety_layer", *machine);
  return meta;
}

std::string ring_of(const Experiment& experiment, const std::string& ring,
                    const std::string& node) {
  return experiment.cards ? replicated::image_name(ring, node) : ring;
}

std::vector<const NodePlan*> awaited_by(const Experiment& experiment, const NodePlan& plan) {
  using experiment::Role;
  std::vector<const NodePlan*> others;
  const Role role = plan.settings.role;
  const auto is_awaited = [&](const NodePlan& other) {
    const MissedSteps missed = other.schedule.missed;
    if (other.host != plan.host || other.settings.program ||
        other.schedule.period != plan.schedule.period)
      return false;
    if (role == Role::Controller)  // also a solver, if it is replayed
      return (missed == MissedSteps::Wait && other.settings.role != Role::Controller) ||
             (missed == MissedSteps::MakeDue && other.settings.role == Role::Machine);
    return role != Role::Controller && other.settings.role == Role::Controller &&
           plan.schedule.missed == MissedSteps::Wait && missed == MissedSteps::Wait;
  };
  if (experiment.cards || plan.settings.program) return others;
  for (const auto& other : experiment.nodes)
    if (is_awaited(other)) others.push_back(&other);
  return others;
}

void await_others(const Experiment& experiment, const NodePlan& plan,
                  adapters::AdapterRunner& runner, broker::Ring& ring) {
  const bool is_machine = plan.settings.role == experiment::Role::Machine;
  const Duration phase = plan.schedule.phase;
  for (const NodePlan* other : awaited_by(experiment, plan)) {
    const Duration its = other->schedule.phase;
    runner.await_steps_of(other->node, phase < its || (phase == its && is_machine), ring);
  }
}

// How long a program may wait for its user before its first target [s].
double longest_wait_for_user(const Experiment& experiment) {
  double longest = 0;
  for (const auto& plan : experiment.nodes)
    if (const auto& program = plan.settings.program)
      longest = std::max(
          longest, program->connect_deadline + program->longest_silence * experiment.time.rate);
  return longest;
}

std::size_t steps_of(const Experiment& experiment, const NodePlan& plan) {
  constexpr double kSlowest = 2, kMargin = 10;  // of the planned duration; [s]
  const double longest =
      (experiment.time.rest + experiment.time.duration * experiment.time.rate) * kSlowest +
      longest_wait_for_user(experiment);
  return static_cast<std::size_t>((longest + kMargin) / to_seconds(plan.schedule.period));
}

void add_faults(const std::vector<std::string>& events, RunEnd& result) {
  for (const auto& event : events) result.faults += (result.faults.empty() ? "" : "; ") + event;
  if (!result.faults.empty() && !result.trouble.empty())
    result.trouble += " (faults: " + result.faults + ")";
}

std::string late_end(const Experiment& experiment, double now) {
  std::string solver;
  for (const auto& plan : experiment.nodes)
    if (plan.settings.solver.may_not_end) solver = plan.node;
  return fmt::format(
      "{}: did not end the test until {:.3f} s, expected its end {:g} s after its first target",
      solver, now, experiment.time.duration * experiment.time.rate);
}

Duration longest_stop(const Experiment& experiment) {
  constexpr double kMarginForPeers = 1.0;  // [s]
  return from_seconds(experiment.stop.longest + kMarginForPeers);
}

namespace {

std::string ending_of(const RunOutcome& outcome) {
  if (outcome.completed) return outcome.stopped_early ? "stopped on request" : "completed";
  return outcome.interrupted ? "interrupted" : outcome.trouble;
}

using NamedSeries = std::vector<std::pair<std::string, recording::Reader::Series>>;

NamedSeries series_of(const Experiment& experiment, const RunEnd& result) {
  NamedSeries series;
  if (!result.lateness.largest.empty())
    series.push_back({"host_late", {result.lateness.interval, result.lateness.largest}});
  for (const auto& plan : experiment.nodes) {
    const auto found = result.times.find(plan.node);
    if (found == result.times.end()) continue;
    const auto& late = found->second.late;
    const auto& duration = found->second.duration;
    const double period = to_seconds(plan.schedule.period);
    series.push_back({kLateSeries + plan.node, {period, {late.begin(), late.end()}}});
    series.push_back({kDurationSeries + plan.node, {period, {duration.begin(), duration.end()}}});
  }
  return series;
}

// Adds data that is available only after the run.
void add_to_meta(const std::filesystem::path& file, const Experiment& experiment,
                 const RunOutcome& outcome, const RunEnd& result) {
  std::string privileges;
  for (const auto& line : result.privileges) privileges += (privileges.empty() ? "" : "; ") + line;
  recording::NamedTexts meta{{"ending", ending_of(outcome)},
                             {"wall_time_s", fmt::format("{:.3f}", outcome.wall_time)},
                             {"privileges", privileges.empty() ? "all" : privileges}};
  if (!result.faults.empty()) meta.emplace_back("faults", result.faults);
  if (!result.foreign_stores.empty())
    meta.emplace_back(recording::kForeignStores, to_text(result.foreign_stores));
  if (outcome.completed && !outcome.stopped_early)
    meta.emplace_back(
        "times_real_time",
        fmt::format("{:.1f}", experiment.time.duration * experiment.time.rate / outcome.wall_time));
  recording::add_meta(file, meta, series_of(experiment, result));
}

}  // namespace

void check_assembly(const Experiment& experiment) {
  static_cast<void>(assemble(experiment, ClockKind::Virtual, {}));
  for (const auto& plan : experiment.nodes)
    if (plan.settings.check) plan.settings.check();
}

RunOutcome run(const Experiment& experiment, const RunOptions& options) {
  std::filesystem::create_directories(options.recording.parent_path());
  const bool records = options.clock == ClockKind::Virtual;  // else a process of its own does
  Assembly assembly =
      assemble(experiment, options.clock,
               {options.recording, describe_run(experiment, options.clock, options.version),
                records ? experiment.texts() : recording::NamedTexts{}});
  const WallClock clock;
  const TimePoint begun = clock.now();
  RunOutcome outcome;
  const RunEnd result = options.clock == ClockKind::Virtual
                            ? run_in_virtual_time(experiment, assembly, options)
                            : run_in_wall_time(experiment, assembly, options);
  outcome.trouble = result.trouble;
  outcome.interrupted = result.interrupted;
  outcome.stopped_early = result.stopped_early;
  outcome.has_ring_faults = !result.faults.empty();
  outcome.completed = outcome.trouble.empty() && !outcome.interrupted;
  outcome.wall_time = to_seconds(clock.now() - begun);
  for (const auto& store : result.foreign_stores) outcome.foreign_stores.push_back(store.text());
  if (!std::filesystem::exists(options.recording)) return outcome;
  try {
    add_to_meta(options.recording, experiment, outcome, result);
    if (outcome.completed)
      outcome.rows_missing = recording::Reader{options.recording}.rows_missing();
  } catch (const Error&) {
    if (outcome.completed) throw;  // otherwise the run's own fault is reported
  }
  return outcome;
}

}  // namespace rths::launch
