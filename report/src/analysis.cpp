// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/maths/bands.hpp>
#include <rths/maths/delay.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/report/report.hpp>

#include "analysis.hpp"
#include "companions.hpp"
#include "evidence.hpp"
#include "solver_time.hpp"
#include "ticks.hpp"

namespace rths::report {
namespace {

constexpr double kWindow = 2.0;        // of windowed tracking [s]
constexpr double kWindowStep = 0.25;   // [s]
constexpr double kWindowSearch = 0.1;  // [s]
constexpr double kQuietShare = 0.02;   // of the largest command: a smaller motion has no delay

WindowedTracking windowed_tracking(const Series& command, const Series& measured) {
  WindowedTracking tracking;
  tracking.delay.start = tracking.nrms.start = kWindow / 2;
  tracking.delay.interval = tracking.nrms.interval = std::max(kWindowStep, command.interval);
  const double largest = largest_magnitude(command.values);
  const auto length = static_cast<std::size_t>(kWindow / command.interval);
  const auto stride =
      std::max<std::size_t>(1, static_cast<std::size_t>(kWindowStep / command.interval));
  if (length == 0) return tracking;
  for (std::size_t begin = 0; begin + length <= command.values.size(); begin += stride) {
    const auto reference = std::span{command.values}.subspan(begin, length);
    const auto response = std::span{measured.values}.subspan(begin, length);
    const auto [low, high] = std::ranges::minmax_element(reference);
    const bool moves = *high - *low > kQuietShare * largest;
    tracking.delay.values.push_back(
        moves ? delay_or_none(reference, response, command.interval, kWindowSearch).minimum_rms
              : std::numeric_limits<double>::quiet_NaN());
    double sum = 0;
    for (std::size_t i = 0; i < length; ++i)
      sum += (response[i] - reference[i]) * (response[i] - reference[i]);
    tracking.nrms.values.push_back(std::sqrt(sum / static_cast<double>(length)) / largest);
  }
  return tracking;
}

// Displacement and force of the specimen at each target: as the controller holds them, or else as
// the solver receives them with its next target. A force that is corrected for the tracking error
// does not belong to the measured displacement, so both are then as measured.
void add_steps(AxisAnalysis& axis, const Reader& run, const Roles& roles, const AxisRoles& names) {
  const auto targets = targets_of(run, roles);
  const auto at_targets = [&](const char* held, const std::string& returned,
                              const std::string& measured) {
    const std::string monitor = roles.monitor_of_controller();
    const std::string block = monitor + "pc." + held + "." + names.axis;
    if (run.has(monitor + "target_force.force." + names.axis))
      return at_each_count(targets, run.signal(measured));
    const std::string name = run.has(block) ? block : run.has(returned) ? returned : measured;
    return at_each_count(targets, run.signal(name));
  };
  axis.step_displacement =
      at_targets("held_displacement", names.returned_displacement, names.displacement);
  axis.step_force = at_targets("held_force", names.returned_force, names.force);
}

void add_compensator(AxisAnalysis& axis, const Reader& run, const Ticks& ticks,
                     const std::string& monitor) {
  const bool is_inverse = !run.has(monitor + "ats.a0." + axis.name);
  const std::string block = monitor + (is_inverse ? "inverse." : "ats.");
  const std::string limited = block + (is_inverse ? "clipped." : "limited.") + axis.name;
  if (!run.has(block + "a0." + axis.name)) return;
  axis.a0 = ticks.series(block + "a0." + axis.name);
  axis.a1 = ticks.series(block + "a1." + axis.name);
  axis.a2 = ticks.series(block + "a2." + axis.name);
  axis.compensator_limited = std::lround(ticks.series(limited).values.back());
}

AxisAnalysis analyse_axis(const Reader& run, const Ticks& ticks, const Roles& roles,
                          const AxisRoles& names) {
  AxisAnalysis result;
  result.name = names.axis;
  result.command = ticks.series(names.command);
  result.measured = ticks.series(names.displacement);
  result.force = ticks.series(names.force);
  add_compensator(result, run, ticks, roles.monitor_of_controller());
  add_steps(result, run, roles, names);
  const auto delay =
      delay_or_none(result.command.values, result.measured.values, ticks.interval(), kDelaySearch);
  const auto error = maths::tracking_error(result.command.values, result.measured.values);
  result.delay = delay.cross_correlation;
  result.delay_min_rms = delay.minimum_rms;
  result.nrms = error.nrms;
  result.peak_error = error.peak;
  result.peak_displacement = largest_magnitude(result.measured.values);
  result.peak_shear = largest_magnitude(result.force.values);
  result.tracking = windowed_tracking(result.command, result.measured);
  result.bands = maths::track_bands(result.command.values, result.measured.values, ticks.interval(),
                                    result.delay);
  return result;
}

// Why an axis has no analysis; empty: it has one.
std::string lack_of(const Reader& run, const Ticks& ticks, const AxisRoles& names) {
  for (const auto& [role, name] :
       {std::pair{"command", &names.command}, std::pair{"displacement", &names.displacement},
        std::pair{"force", &names.force}})
    if (!run.has(*name))
      return fmt::format(
          "the recording lacks '{}', the {}; [roles] of the experiment can name "
          "another signal",
          *name, role);
  if (!(largest_magnitude(ticks.series(names.command).values) > 0))
    return fmt::format("'{}', the command, is zero throughout", names.command);
  return "";
}

/// The analysed axes, and why the others are not.
struct AxesAnalysis {
  std::vector<AxisAnalysis> axes;
  std::vector<LeftOut> left_out;
};

AxesAnalysis analyse_axes(const Reader& run, const Ticks& ticks, const Roles& roles) {
  AxesAnalysis result;
  auto& [axes, lacks] = result;
  for (const auto& names : roles.axes)
    if (auto lack = lack_of(run, ticks, names); lack.empty())
      axes.push_back(analyse_axis(run, ticks, roles, names));
    else
      lacks.push_back({"axis " + names.axis, std::move(lack)});
  // Without any axis, the reason stands in the place of the figures.
  if (axes.empty() && !lacks.empty())
    lacks = {{"response", lacks[0].reason}, {"tracking", lacks[0].reason}};
  return result;
}

void add_raw_delay(AxisAnalysis& axis, const Ticks& ticks, const AxisRoles& names) {
  const auto command = ticks.series(names.command);
  const auto measured = ticks.series(names.displacement);
  const auto delay = delay_or_none(command.values, measured.values, ticks.interval(), kDelaySearch);
  axis.raw_delay = delay.cross_correlation;
  axis.raw_delay_min_rms = delay.minimum_rms;
  axis.raw_nrms = maths::tracking_error(command.values, measured.values).nrms;
}

void add_raw_delays(const Reader& uncompensated, std::vector<AxisAnalysis>& axes) {
  const Roles roles = recording::roles_of(uncompensated);
  const Ticks ticks{uncompensated, roles};
  for (auto& axis : axes)
    for (const auto& names : roles.axes)
      if (names.axis == axis.name) add_raw_delay(axis, ticks, names);
}

StepAnalysis analyse_steps(const Reader& run, const Roles& roles, const RecordedLateness& host) {
  StepAnalysis steps;
  const auto targets = targets_of(run, roles);
  steps.start = at_each_count(targets, run.time());
  const std::string block = roles.monitor_of_controller() + "pc.";
  if (!run.has(block + "predict_time")) return steps;
  // The times of a step are published with the next target, so they are shifted by one.
  const auto closed = [&](const char* signal) {
    auto values = at_each_count(targets, run.signal(block + signal));
    if (!values.empty()) values.erase(values.begin());
    return values;
  };
  steps.correct = closed("correct_time");
  steps.predict = closed("predict_time");
  steps.slow = closed("slow_down_time");
  for (std::size_t i = 0; i < steps.slow.size(); ++i) {
    const bool excused = host.was_late(steps.start[i], steps.start[i + 1]);
    steps.excused.push_back(excused);
    steps.excused_count += excused ? 1 : 0;
    if (steps.slow[i] > 0) ++(excused ? steps.slow_downs_excused : steps.slow_downs);
  }
  return steps;
}

std::vector<NodeAnalysis> analyse_nodes(const Reader& run) {
  std::vector<NodeAnalysis> nodes;
  for (const auto& [name, count] : run.drops()) {
    static_cast<void>(count);
    const std::string prefix = "monitor." + name + ".host.";
    if (!run.has(prefix + "late")) continue;
    const auto late = run.signal(prefix + "late");
    NodeAnalysis node;
    node.name = name;
    node.steps = std::lround(run.signal(prefix + "step").back());
    node.overruns = std::lround(run.signal(prefix + "overruns").back());
    node.stale = std::lround(run.signal(prefix + "stale").back());
    node.late_p50 = maths::quantile(late, 0.50);
    node.late_p99 = maths::quantile(late, 0.99);
    node.late_max = run.signal(prefix + "late_max").back();
    nodes.push_back(node);
  }
  return nodes;
}

RunTiming timing_of(const Reader& run, const Ticks& ticks, const StepAnalysis& steps,
                    const RunDescription& test) {
  const SolverTime solver = solver_time_of(run);
  const auto count = static_cast<double>(steps.start.size());
  const double reached = !solver.signal.empty() && !solver.moves.empty() ? solver.moves.back().time
                         : count > 0 ? count * test.integration_step
                                     : model_time_at(run.time().back(), test.rest, test.rate);
  return {reached, 1 / ticks.interval(), achieved_rate(solver, test.integration_step)};
}

HostAnalysis analyse_hosts(const Reader& run, const RecordedLateness& host,
                           const std::optional<Reader>& real_time) {
  HostAnalysis hosts;
  const auto meta = run.meta();
  if (const auto processes = meta.find("processes"); processes != meta.end())
    hosts.processes = std::stoi(processes->second);
  if (real_time) hosts.real_time = late_host_in(*real_time);
  hosts.late = host.late;
  hosts.nodes = analyse_nodes(run);
  hosts.hops = analyse_hops(run);
  hosts.drops = run.drops();
  hosts.rows_missing = run.rows_missing();
  return hosts;
}

// Reasons for the sections that depend on the solver, the controller and on companion runs.
std::vector<LeftOut> left_out_of(const Analysis& analysis, const Roles& roles,
                                 bool has_uncompensated, bool has_numerical) {
  std::vector<LeftOut> left_out;
  if (analysis.axes.empty() || analysis.axes[0].a0.values.empty())
    left_out.push_back(
        {"compensation", fmt::format("no block 'ats' or 'inverse' of a controller '{}' is recorded",
                                     roles.controller)});
  if (analysis.steps.predict.empty())
    left_out.push_back(
        {"predictor-corrector",
         fmt::format("no block 'pc' of a controller '{}' is recorded", roles.controller)});
  if (!has_uncompensated)
    left_out.push_back({"raw delay",
                        "there is no run without compensation: the experiment has no "
                        "[uncompensated], or a node has no virtual time"});
  if (!has_numerical)
    left_out.push_back({"numerical result", analysis.test.ending.empty()
                                                ? "the structure of the solver is its own: state "
                                                  "it as [plant] or its response as [reference]"
                                                : "the run ended early"});
  if (analysis.spectra.floors.empty())
    left_out.push_back(
        {"floor spectra",
         fmt::format("the solver '{}' records no floor accelerations", roles.solver)});
  return left_out;
}

std::optional<Reader> open_if_there(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  return Reader{file};
}

// The values from a time on.
std::vector<double> from(double time, const Series& series) {
  const auto first = static_cast<std::ptrdiff_t>(std::lround(time / series.interval));
  const auto count = static_cast<std::ptrdiff_t>(series.values.size());
  return {series.values.begin() + std::clamp<std::ptrdiff_t>(first, 0, count), series.values.end()};
}

std::vector<double> without_mean(std::vector<double> values) {
  const double middle = maths::mean(values);
  for (double& value : values) value -= middle;
  return values;
}

}  // namespace

maths::DelayIdentification delay_or_none(std::span<const double> command,
                                         std::span<const double> measured, double interval,
                                         double search) {
  try {
    return maths::identify_delay(command, measured, interval, search);
  } catch (const Error&) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone};
  }
}

bool RecordedLateness::was_late(double from, double to) const {
  if (late.values.empty()) return false;
  const auto first = static_cast<std::size_t>(std::max(0.0, from / late.interval));
  const auto last = static_cast<std::size_t>(std::max(0.0, to / late.interval));
  for (std::size_t i = first; i <= last && i < late.values.size(); ++i)
    if (late.values[i] >= period) return true;
  return false;
}

RecordedLateness lateness_of(const Reader& run) {
  constexpr double kUsualPeriod = 1e-3;  // [s]
  const auto late = run.meta_series("host_late");
  RecordedLateness host{{0, late.interval, late.values}, kUsualPeriod};
  try {
    host.period = Ticks{run, recording::roles_of(run)}.interval();
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): the controller made no step
  }
  return host;
}

double model_time_at(double wall_time, double rest, double rate) {
  return std::max(0.0, wall_time - rest) / rate;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::ranges::max_element(values);
}

std::optional<double> most_extreme(std::span<const double> values) {
  const auto found = std::ranges::max_element(
      values, [](double a, double b) { return std::abs(a) < std::abs(b); });
  return found == values.end() ? std::nullopt : std::optional{*found};
}

std::vector<double> targets_of(const Reader& run, const Roles& roles) {
  const std::string counted = roles.monitor_of_controller() + "pc.targets";
  if (run.has(counted)) return run.signal(counted);
  const std::string solved = "monitor." + roles.solver + ".step";
  if (run.has(solved)) return run.signal(solved);
  if (!run.has(roles.new_target)) return {};
  auto flag = run.signal(roles.new_target);
  const auto& target = roles.axes.empty() ? std::string{} : roles.axes[0].target;
  const auto value = run.has(target) ? run.signal(target) : std::vector<double>(flag.size());
  double count = 0, before = 0;
  bool awaits_flag = false;  // the value of a target can be recorded before its flag, or without
  for (std::size_t row = 0; row < flag.size(); ++row) {
    const bool rises = flag[row] > 0 && flag[row] != before;
    const bool changes = row > 0 && value[row] != value[row - 1];
    if (changes || (rises && !awaits_flag)) ++count;
    awaits_flag = (changes || awaits_flag) && !(flag[row] > 0);
    before = flag[row];
    flag[row] = count;
  }
  return flag;
}

StructureAnalysis analyse_structure(const Reader& run, const std::string& solver, double step) {
  StructureAnalysis found{run.config(recording::kStructureText), step, {}, {}, 0};
  const std::string monitor = "monitor." + solver + ".";
  if (!run.has(monitor + "bearings.lifted")) return found;
  const auto at_targets = [&](const char* name) {
    return at_each_count(run.signal(monitor + "step"), run.signal(monitor + name));
  };
  found.least = at_targets("bearings.least_load");
  found.largest = at_targets("bearings.largest_load");
  found.lifted = largest(at_targets("bearings.lifted"));
  return found;
}

Analysis analyse(const std::filesystem::path& folder) {
  const Reader run{folder / kRunFile};
  if (run.rows() < 2) throw Error{(folder / kRunFile).string() + ": contains no motion"};
  const auto uncompensated = open_if_there(folder / kUncompensatedFile);
  const auto numerical = open_if_there(folder / kNumericalFile);
  const auto improved = open_if_there(folder / kImprovedFile);
  const auto given = [](const auto& reader) { return reader ? &*reader : nullptr; };
  const RecordedLateness host = lateness_of(run);
  const Roles roles = recording::roles_of(run);
  const Ticks ticks{run, roles};
  AxesAnalysis found = analyse_axes(run, ticks, roles);
  if (uncompensated) add_raw_delays(*uncompensated, found.axes);
  Analysis analysis;
  analysis.test = describe(run);
  const RunDescription& test = analysis.test;
  analysis.axes = std::move(found.axes);
  analysis.steps = analyse_steps(run, roles, host);
  const auto& starts = analysis.steps.start;
  analysis.timing = timing_of(run, ticks, analysis.steps, test);
  analysis.vertical =
      analyse_vertical(run, ticks, roles, test.rate, starts.empty() ? 0 : starts[0] / test.rate);
  analysis.hosts = analyse_hosts(run, host, open_if_there(folder / kRealTimeFile));
  analysis.changes = operator_changes(run);
  analysis.safety = safety_changes(run);
  analysis.companions = analyse_companions(run, roles, test.integration_step, analysis.axes,
                                           {given(numerical), given(improved)});
  analysis.spectra =
      analyse_spectra(run, roles.solver, test.integration_step, given(numerical), given(improved));
  analysis.structure = analyse_structure(run, roles.solver, test.integration_step);
  analysis.left_out = std::move(found.left_out);
  for (auto& one : left_out_of(analysis, roles, uncompensated.has_value(), numerical.has_value()))
    analysis.left_out.push_back(std::move(one));
  return analysis;
}

std::optional<VerticalAnalysis> analyse_vertical(const Reader& run, const Ticks& ticks,
                                                 const Roles& roles, double rate, double first) {
  if (!run.has(roles.vertical_command) || !run.has(roles.vertical_measured)) return std::nullopt;
  VerticalAnalysis vertical;
  const auto in_model_time = [&](const std::string& signal) {
    Series series = ticks.series(signal);
    series.interval /= rate;
    return series;
  };
  vertical.command = in_model_time(roles.vertical_command);
  vertical.measured = in_model_time(roles.vertical_measured);
  const auto command = from(first, vertical.command), measured = from(first, vertical.measured);
  if (command.size() < 2) return std::nullopt;
  const auto [low, high] = std::ranges::minmax_element(command);
  vertical.span = *high - *low;
  if (!(vertical.span > 0)) return std::nullopt;
  vertical.error = maths::tracking_error(command, measured).rms / vertical.span;
  // The weight, which all samples share, has neither a delay nor a frequency.
  const auto varying = without_mean(command), answer = without_mean(measured);
  vertical.delay =
      delay_or_none(varying, answer, vertical.command.interval, kDelaySearch).minimum_rms;
  vertical.bands = maths::track_bands(varying, answer, vertical.command.interval, vertical.delay);
  vertical.coherence = maths::coherence_of(varying, answer, vertical.command.interval);
  return vertical;
}

}  // namespace rths::report
