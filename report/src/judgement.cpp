// SPDX-License-Identifier: Apache-2.0
#include <rths/report/judgement.hpp>

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include <rths/core/status.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/recording/foreign_stores.hpp>

#include "analysis.hpp"
#include "conditions.hpp"
#include "solver_time.hpp"

namespace rths::report {
namespace {

constexpr double kRounding = 0.5;  // of an integration step

double end_of(const Reader& run) { return run.time().empty() ? 0 : run.time().back(); }

Break end_of_run(const Reader& run, const SolverTime& solver, const Config& experiment) {
  const double planned = experiment.number("duration_s");
  const double step = experiment.number("integration_step_s", 0.01);
  const auto meta = run.meta();
  const auto ending = meta.find("ending");
  const std::string how = ending == meta.end() ? "not recorded" : ending->second;
  const std::string signal = recording::roles_of(run).time;
  const double reached = reached_in(run, solver, experiment, how == "completed");
  if (how == "completed" && reached > planned - (1 + kRounding) * step) return {};
  return Broken{"end", end_of(run), signal, fmt::format("{:.2f} s, ending: {}", reached, how),
                fmt::format("{:g} s, ending: completed", planned)};
}

Break missing_rows(const Reader& run, const Bounds& bounds) {
  const auto& time = run.time();
  if (time.size() < 2)
    return Broken{"rows", 0, "time", fmt::format("{} rows", time.size()), "a test"};
  const auto gaps = maths::steps_of(time);
  const double period = maths::quantile(gaps, 0.5);
  double missing = 0, first = 0;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    if (gaps[i] < 1.5 * period) continue;
    if (missing == 0) first = time[i];
    missing += gaps[i] / period - 1;
  }
  const double share = missing / (missing + static_cast<double>(time.size()));
  if (share <= bounds.missing) return {};
  return Broken{"rows", first, "time", fmt::format("{:.1f} % of the rows are missing", 100 * share),
                fmt::format("at most {:g} %", 100 * bounds.missing)};
}

// Counters of the nodes' steps; the recorder's own steps are the rows.
std::vector<std::string> nodes_of(const Reader& run) {
  std::vector<std::string> nodes;
  for (const auto& [node, drops] : run.drops()) {
    static_cast<void>(drops);
    if (!run.has("monitor." + node + ".lost_rows")) nodes.push_back(node);
  }
  return nodes;
}

Break unseen_steps(const Reader& run, const std::string& node, const Bounds& bounds) {
  const auto counter = run.signal("monitor." + node + ".host.step");
  const double steps = *std::ranges::max_element(counter);
  for (const auto& [name, drops] : run.drops()) {
    const auto unseen = static_cast<double>(drops);
    if (name != node || unseen <= bounds.missing * steps) continue;
    return Broken{"rows", end_of(run), node,
                  fmt::format("{:.1f} % of its steps have no row", 100 * unseen / steps),
                  fmt::format("at most {:g} %", 100 * bounds.missing)};
  }
  return {};
}

Break restart_of(const Reader& run, const std::string& node) {
  const std::string signal = "monitor." + node + ".host.step";
  const auto counter = run.signal(signal);
  for (std::size_t i = 1; i < counter.size(); ++i)
    if (counter[i] < counter[i - 1])
      return Broken{
          "restart", run.time()[i], node,
          fmt::format("its step count fell from {:.0f} to {:.0f}", counter[i - 1], counter[i]),
          "the same process to the end"};
  return {};
}

// Of several words, the first.
Break owner_of(const Reader& run) {
  const auto stores = recording::foreign_stores_of(run);
  if (stores.empty()) return {};
  const auto& first = stores.front();
  const std::string others =
      stores.size() == 1
          ? ""
          : fmt::format("; and {} more word{}", stores.size() - 1, stores.size() == 2 ? "" : "s");
  return Broken{"owner", first.time, first.signal, first.found() + others, first.expected()};
}

// Invalid or torn inputs. A host that is late in the midst of a write excuses them.
Break stale_input(const Reader& run, const std::string& node, const RecordedLateness& host) {
  const std::string signal = "monitor." + node + ".host.stale";
  const auto count = run.signal(signal);
  const std::size_t rows = test_rows(run);
  double stale = 0, first = 0;
  for (std::size_t i = 1; i < rows; ++i) {
    const double time = run.time()[i];
    if (!(count[i] > count[i - 1]) || host.was_late(time - 0.01, time + 0.01)) continue;
    if (stale == 0) first = time;
    stale += count[i] - count[i - 1];
  }
  if (stale == 0) return {};
  return Broken{"stale", first, signal, fmt::format("{:.0f} steps without valid inputs", stale),
                "none"};
}

Break node_limit(const Reader& run, const std::string& node, const Bounds& bounds) {
  const std::string signal = "monitor." + node + ".host.status";
  const auto status = run.signal(signal);
  const auto& time = run.time();
  const std::size_t rows = test_rows(run);
  double duration = 0, first = 0;
  for (std::size_t i = 1; i < rows; ++i) {
    if (status[i] != static_cast<double>(Status::LimitExceeded)) continue;
    if (duration == 0) first = time[i];
    duration += time[i] - time[i - 1];
  }
  if (duration <= bounds.at_limits) return {};
  return Broken{"limit", first, signal,
                fmt::format("stroke, velocity or force at its limit for {:.3f} s", duration),
                fmt::format("at most {:g} s", bounds.at_limits)};
}

Break late_host(const Reader& run, const RecordedLateness& host, const Bounds& bounds) {
  const auto targets = targets_of(run, recording::roles_of(run));
  if (targets.empty() || host.late.values.empty()) return {};
  const auto start = at_each_count(targets, run.time());
  double late = 0, first = 0;
  for (std::size_t i = 1; i < start.size(); ++i) {
    if (!host.was_late(start[i - 1], start[i])) continue;
    if (late == 0) first = start[i - 1];
    ++late;
  }
  const auto steps = static_cast<double>(start.size());
  if (late <= bounds.late * steps) return {};
  return Broken{"host", first, "host_late",
                fmt::format("late in {:.1f} % of the steps", 100 * late / steps),
                fmt::format("at most {:g} %: run again", 100 * bounds.late)};
}

Break response_of(const Reader& run, const std::string& axis, double difference,
                  const Bounds& bounds) {
  if (difference <= bounds.response) return {};
  const auto roles = recording::roles_of(run);
  const auto words =
      std::ranges::find_if(roles.axes, [&](const auto& one) { return one.axis == axis; });
  return Broken{"response", end_of(run), words->target,
                fmt::format("{:.1f} % from the numerical result", 100 * difference),
                fmt::format("at most {:g} %", 100 * bounds.response)};
}

// Collects the broken conditions.
class RunJudgement {
 public:
  explicit RunJudgement(const std::vector<AxisEvidence>& axes) : axes_{axes} {}
  void add(Break broken) {
    if (broken) broken_.push_back(std::move(*broken));
  }
  [[nodiscard]] std::vector<Broken> by_time() {
    std::ranges::stable_sort(broken_, [](const auto& a, const auto& b) { return a.time < b.time; });
    return std::move(broken_);
  }
  /// Until when the model moves as the specimen: 0 if displacement and acceleration contradict each
  /// other or stand still, else the first jump or noise of a displacement [s].
  [[nodiscard]] double time_of_valid_motion() const {
    double until = std::numeric_limits<double>::infinity();
    for (const auto& b : broken_) {
      const bool is_displacement = is_one_of(b.signal, &AxisEvidence::displacement);
      const bool is_acceleration = is_one_of(b.signal, &AxisEvidence::acceleration);
      if (b.condition == "motion" || (b.condition == "offset" && !has("tracking")) ||
          (b.condition == "live" && (is_displacement || is_acceleration)))
        return 0;
      if (is_displacement && (b.condition == "jump" || b.condition == "noise"))
        until = std::min(until, b.time);
    }
    return until;
  }

 private:
  [[nodiscard]] bool has(const std::string& condition) const {
    return std::ranges::any_of(broken_,
                               [&](const Broken& broken) { return broken.condition == condition; });
  }

  [[nodiscard]] bool is_one_of(const std::string& signal,
                               RecordedSignal AxisEvidence::*word) const {
    return std::ranges::any_of(
        axes_, [&](const AxisEvidence& axis) { return (axis.*word).name == signal; });
  }

  const std::vector<AxisEvidence>& axes_;
  std::vector<Broken> broken_;
};

void judge_run(RunJudgement& judgement, const Reader& run, const Config& experiment,
               const Bounds& bounds) {
  const SolverTime solver = solver_time_of(run);
  judgement.add(end_of_run(run, solver, experiment));
  judgement.add(safety_of(run));
  judgement.add(owner_of(run));
  judgement.add(missing_rows(run, bounds));
  if (run.rows() < 2) return;
  const double step = experiment.number("integration_step_s", 0.01);
  // The spring of an echo answers at any rate.
  if (!recording::node_with(experiment.table("node"), {"echo"}))
    judgement.add(rate_of(solver, experiment.number("rate", 1), step));
  // A solver of this project advances by a step with each target.
  if (!recording::node_with(experiment.table("node"), {"numerical"})) {
    judgement.add(time_of(solver, step));
    judgement.add(targets_limit_of(run, solver));
    judgement.add(targets_live_of(run, solver));
  }
  const RecordedLateness host = lateness_of(run);
  judgement.add(late_host(run, host, bounds));
  for (const auto& node : nodes_of(run)) {
    judgement.add(unseen_steps(run, node, bounds));
    judgement.add(restart_of(run, node));
    judgement.add(stale_input(run, node, host));
    judgement.add(node_limit(run, node, bounds));
  }
}

void judge_axes(RunJudgement& judgement, const Evidence& evidence, const Bounds& bounds) {
  for (const auto& axis : evidence.axes) {
    judgement.add(limit_of(axis, evidence, bounds));
    for (const auto& wire : wires_of(axis, evidence, bounds))
      judgement.add(wire_of(wire, evidence));
    judgement.add(tracking_of(axis, evidence, bounds));
    judgement.add(offset_of(axis, evidence, bounds));
    judgement.add(motion_of(axis, evidence, bounds));
    for (const auto& feedback : feedbacks_of(axis, bounds)) {
      judgement.add(live_of(feedback, evidence, bounds));
      judgement.add(jump_of(feedback, evidence));
      judgement.add(noise_of(feedback, evidence, bounds));
    }
  }
  judgement.add(load_limit_of(evidence));
  judgement.add(load_of(evidence, bounds));
  // The expected force follows from the measured motion of both axes.
  const double until = judgement.time_of_valid_motion();
  for (const auto& axis : evidence.axes) judgement.add(force_of(axis, evidence, bounds, until));
}

}  // namespace

std::size_t test_rows(const Reader& run) {
  const std::string name = recording::roles_of(run).new_target;
  if (!run.has(name)) return run.rows();
  const auto flag = run.signal(name);
  return static_cast<std::size_t>(
      std::ranges::find_if(flag, [](double value) { return value < 0; }) - flag.begin());
}

Bounds read_bounds(const Config& table) {
  Bounds b;
  const auto fraction = [&](const char* key, double& value) {
    value = table.number_in(key, 0, 1e3, value);
  };
  fraction("time_at_limits_s", b.at_limits);
  fraction("nrms", b.nrms);
  fraction("window_nrms", b.window_nrms);
  fraction("delay_s", b.delay);
  fraction("resolution_m", b.resolution);
  fraction("displacement_offset", b.offset);
  fraction("motion_difference", b.motion);
  fraction("response", b.response);
  b.force_factor = table.number_in("force_factor", 1, 1e3, b.force_factor);
  fraction("force_delay_s", b.force_delay);
  fraction("force_offset", b.force_offset);
  fraction("displacement_jump", b.displacement_jump);
  fraction("force_jump", b.force_jump);
  fraction("noise", b.noise);
  fraction("repeated_samples", b.repeated);
  fraction("load_difference", b.load);
  fraction("missing_rows", b.missing);
  fraction("late_steps", b.late);
  table.reject_unknown_keys();
  return b;
}

std::string Broken::text() const {
  return fmt::format("{} at {:.3f} s: {}: found {}, expected {}", condition, time, signal, found,
                     expected);
}

std::vector<Broken> judge(const Reader& run, const Reader* numerical) {
  const auto recorded = recording::experiment_in(run);
  if (!recorded) throw Error{"the recording holds no experiment, expected /config"};
  const Config& experiment = *recorded;
  const Bounds bounds = read_bounds(experiment.table_or_empty("conclusive"));
  const Evidence evidence = run.rows() > 1 ? gather(run, experiment) : Evidence{};
  RunJudgement judgement{evidence.axes};
  judge_run(judgement, run, experiment, bounds);
  judge_axes(judgement, evidence, bounds);
  if (numerical != nullptr && run.rows() > 1)
    for (const auto& [axis, difference] : response_differences(run, *numerical))
      judgement.add(response_of(run, axis, difference, bounds));
  return judgement.by_time();
}

}  // namespace rths::report
