// SPDX-License-Identifier: Apache-2.0
#include "analysis.hpp"
#include "evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include <rths/controller/delay.hpp>
#include <rths/core/error.hpp>
#include <rths/report/report.hpp>

namespace rths::report {
namespace {

using recording::at_each_count;
using recording::Reader;

constexpr double kDelaySearch = 0.2;       // [s]
constexpr double kWindow = 2.0;            // of windowed tracking [s]
constexpr double kWindowStep = 0.25;       // [s]
constexpr double kWindowSearch = 0.1;      // [s]
constexpr double kQuietShare = 0.02;       // of the largest command: a smaller motion has no delay
constexpr double kExcusedLateness = 1e-3;  // of the host: one controller tick [s]

const std::vector<std::string> kAxes = {"long", "lat"};

// Tick interval between the first counted row and the first row of the final count, when the node
// left.
double period_of(const std::vector<double>& time, const std::vector<double>& counter) {
  const auto first = std::find_if(counter.begin(), counter.end(), [](double c) { return c >= 1; });
  const auto last = std::find(first, counter.end(), counter.back());
  const double counts = last == counter.end() ? 0 : *last - *first;
  if (!(counts > 0)) throw Error{"the recording contains no steps of the controller"};
  const auto row = [&](auto at) { return static_cast<std::size_t>(at - counter.begin()); };
  return (time[row(last)] - time[row(first)]) / counts;
}

/// Series of the controller's signals, one value per tick.
class ControllerTicks {
 public:
  explicit ControllerTicks(const Reader& reader)
      : ticks_{reader, "xpc"}, interval_{period_of(reader.time(), ticks_.counter())} {}
  [[nodiscard]] Series series(const std::string& signal) const {
    return {0, interval_, ticks_.values(signal)};
  }
  [[nodiscard]] double interval() const { return interval_; }
  [[nodiscard]] std::size_t count() const { return ticks_.count(); }

 private:
  recording::NodeTicks ticks_;
  double interval_;
};

// Without motion there is no delay.
controller::DelayIdentification delay_or_none(std::span<const double> command,
                                              std::span<const double> measured, double interval,
                                              double search) {
  try {
    return controller::identify_delay(command, measured, interval, search);
  } catch (const Error&) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone};
  }
}

WindowedTracking windowed_tracking(const Series& command, const Series& measured) {
  WindowedTracking tracking;
  tracking.delay.start = tracking.nrms.start = kWindow / 2;
  tracking.delay.interval = tracking.nrms.interval = kWindowStep;
  const double largest = largest_magnitude(command.values);
  const auto length = static_cast<std::size_t>(kWindow / command.interval);
  const auto stride = static_cast<std::size_t>(kWindowStep / command.interval);
  for (std::size_t begin = 0; begin + length <= command.values.size(); begin += stride) {
    const auto reference = std::span{command.values}.subspan(begin, length);
    const auto response = std::span{measured.values}.subspan(begin, length);
    const auto [low, high] = std::minmax_element(reference.begin(), reference.end());
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

AxisAnalysis analyse_axis(const Reader& run, const ControllerTicks& ticks,
                          const std::string& axis) {
  AxisAnalysis result;
  result.name = axis;
  result.command = ticks.series("monitor.xpc.pc.command." + axis);
  result.measured = ticks.series("monitor.xpc.displacement.out." + axis);
  result.force = ticks.series("monitor.xpc.observer.force." + axis);
  result.a0 = ticks.series("monitor.xpc.ats.a0." + axis);
  result.a1 = ticks.series("monitor.xpc.ats.a1." + axis);
  result.a2 = ticks.series("monitor.xpc.ats.a2." + axis);
  result.ats_limited = std::lround(ticks.series("monitor.xpc.ats.limited." + axis).values.back());
  const auto targets = run.signal("monitor.xpc.pc.targets");
  result.step_displacement =
      at_each_count(targets, run.signal("monitor.xpc.pc.held_displacement." + axis));
  result.step_force = at_each_count(targets, run.signal("monitor.xpc.pc.held_force." + axis));
  const auto delay =
      delay_or_none(result.command.values, result.measured.values, ticks.interval(), kDelaySearch);
  const auto error = controller::tracking_error(result.command.values, result.measured.values);
  result.delay = delay.cross_correlation;
  result.delay_min_rms = delay.minimum_rms;
  result.nrms = error.nrms;
  result.peak_error = error.peak;
  result.peak_displacement = largest_magnitude(result.measured.values);
  result.peak_shear = largest_magnitude(result.force.values);
  result.tracking = windowed_tracking(result.command, result.measured);
  result.bands =
      track_bands(result.command.values, result.measured.values, ticks.interval(), result.delay);
  return result;
}

void add_raw_delay(AxisAnalysis& axis, const ControllerTicks& ticks) {
  const auto command = ticks.series("monitor.xpc.pc.command." + axis.name);
  const auto measured = ticks.series("monitor.xpc.displacement.out." + axis.name);
  const auto delay = delay_or_none(command.values, measured.values, ticks.interval(), kDelaySearch);
  axis.raw_delay = delay.cross_correlation;
  axis.raw_delay_min_rms = delay.minimum_rms;
  axis.raw_nrms = controller::tracking_error(command.values, measured.values).nrms;
}

StepAnalysis analyse_steps(const Reader& run, const Series& host_late) {
  StepAnalysis steps;
  const auto targets = run.signal("monitor.xpc.pc.targets");
  // The times of a step are published with the next target, so they are shifted by one.
  const auto closed = [&](const char* signal) {
    auto values = at_each_count(targets, run.signal(signal));
    if (!values.empty()) values.erase(values.begin());
    return values;
  };
  steps.start = at_each_count(targets, run.time());
  steps.correct = closed("monitor.xpc.pc.correct_time");
  steps.predict = closed("monitor.xpc.pc.predict_time");
  steps.slow = closed("monitor.xpc.pc.slow_down_time");
  for (std::size_t i = 0; i < steps.slow.size(); ++i) {
    const bool excused = host_was_late(host_late, steps.start[i], steps.start[i + 1]);
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
    const auto late = run.signal(prefix + "late");
    NodeAnalysis node;
    node.name = name;
    node.steps = std::lround(run.signal(prefix + "step").back());
    node.overruns = std::lround(run.signal(prefix + "overruns").back());
    node.stale = std::lround(run.signal(prefix + "stale").back());
    node.late_p50 = percentile(late, 0.50);
    node.late_p99 = percentile(late, 0.99);
    node.late_max = run.signal(prefix + "late_max").back();
    nodes.push_back(node);
  }
  return nodes;
}

// Difference between the test's target and the displacement of a model instead of the specimen.
double difference(const Reader& run, const NumericalAxis& model, double interval) {
  const auto steps = run.signal("monitor.opf.step");
  const auto time = at_each_count(steps, run.signal("opf.1.time.target"));
  const auto target = at_each_count(steps, run.signal("opf." + model.name + ".displ.target"));
  double apart = 0, all = 0;
  for (std::size_t i = 0; i < target.size(); ++i) {
    const auto row = std::lround(time[i] / interval) - 1;
    if (row < 0 || row >= static_cast<long>(model.displacement.size())) continue;
    const double error = model.displacement[static_cast<std::size_t>(row)] - target[i];
    apart += error * error;
    all += target[i] * target[i];
  }
  return all > 0 ? std::sqrt(apart / all) : 0;
}

std::vector<NumericalAxis> numerical_axes(const Analysis& analysis, const Reader& run,
                                          const Reader& numerical) {
  std::vector<NumericalAxis> axes;
  for (const auto& axis : analysis.axes) {
    NumericalAxis result;
    result.name = axis.name;
    result.displacement = numerical.signal("result.displ." + axis.name);
    result.force = numerical.signal("result.force." + axis.name);
    result.peak_displacement = largest_magnitude(result.displacement);
    result.peak_shear = largest_magnitude(result.force);
    result.difference = difference(run, result, analysis.numerical_interval);
    axes.push_back(std::move(result));
  }
  return axes;
}

void add_companions(Analysis& analysis, const Reader& run, const Reader* numerical,
                    const Reader* improved) {
  if (numerical == nullptr) return;
  analysis.numerical_interval = numerical->time()[1] - numerical->time()[0];
  analysis.numerical = numerical_axes(analysis, run, *numerical);
  if (improved != nullptr) analysis.improved = numerical_axes(analysis, run, *improved);
}

std::optional<Reader> open_if_there(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  return Reader{file};
}

}  // namespace

bool host_was_late(const Series& host_late, double from, double to) {
  if (host_late.values.empty()) return false;
  const auto first = static_cast<std::size_t>(std::max(0.0, from / host_late.interval));
  const auto last = static_cast<std::size_t>(std::max(0.0, to / host_late.interval));
  for (std::size_t i = first; i <= last && i < host_late.values.size(); ++i)
    if (host_late.values[i] >= kExcusedLateness) return true;
  return false;
}

double mean(std::span<const double> values) {
  return values.empty() ? 0
                        : std::accumulate(values.begin(), values.end(), 0.0) /
                              static_cast<double>(values.size());
}

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const auto index = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

Analysis analyse(const std::filesystem::path& folder) {
  const Reader run{folder / kRunFile};
  if (run.rows() < 2) throw Error{(folder / kRunFile).string() + ": contains no motion"};
  const auto uncompensated = open_if_there(folder / kUncompensatedFile);
  const auto numerical = open_if_there(folder / kNumericalFile);
  const auto improved = open_if_there(folder / kImprovedFile);
  Analysis analysis;
  analysis.meta = run.meta();
  analysis.clock = analysis.meta["clock"];
  analysis.map = run.map().description().name;
  if (analysis.meta.count("processes") > 0)
    analysis.processes = std::stoi(analysis.meta["processes"]);
  describe(analysis, run);
  analysis.changes = operator_changes(run);
  const auto late = run.meta_series("host_late");
  analysis.host_late = {0, late.interval, late.values};
  const ControllerTicks ticks{run};
  analysis.control_rate = 1 / ticks.interval();
  for (const auto& axis : kAxes) {
    if (!run.has("monitor.xpc.pc.command." + axis)) continue;
    analysis.axes.push_back(analyse_axis(run, ticks, axis));
    if (uncompensated) add_raw_delay(analysis.axes.back(), ControllerTicks{*uncompensated});
  }
  analysis.steps = analyse_steps(run, analysis.host_late);
  analysis.duration = run.signal("opf.1.time.target").back();
  analysis.nodes = analyse_nodes(run);
  analysis.hops = analyse_hops(run);
  analysis.drops = run.drops();
  analysis.rows_missing = run.rows_missing();
  const auto given = [](const auto& reader) { return reader ? &*reader : nullptr; };
  add_companions(analysis, run, given(numerical), given(improved));
  add_spectra(analysis, run, given(numerical), given(improved));
  return analysis;
}

}  // namespace rths::report
