// SPDX-License-Identifier: Apache-2.0
#include "evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <rths/core/axis.hpp>
#include <rths/recording/roles.hpp>

namespace rths::report {
namespace {

using recording::AxisRoles, recording::NodeTicks, recording::Roles, recording::at_each_count;

constexpr std::size_t kPiece = 20;      // with one delay of a copy [ticks]
constexpr std::size_t kSmoothing = 10;  // ticks to either side: less noise in the model's velocity

RecordedSignal word(const Reader& run, const NodeTicks& ticks, const std::string& name) {
  if (!run.has(name)) return {name, {}};
  return {name, ticks.values(name)};
}

std::vector<double> smoothed(const std::vector<double>& values) {
  std::vector<double> sums(values.size() + 1, 0.0);
  std::partial_sum(values.begin(), values.end(), sums.begin() + 1);
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t reach = std::min({kSmoothing, i, values.size() - 1 - i});
    result[i] = (sums[i + reach + 1] - sums[i - reach]) / static_cast<double>(2 * reach + 1);
  }
  return result;
}

AxisEvidence axis_of(const Reader& run, const NodeTicks& ticks, const Roles& roles,
                     const AxisRoles& names) {
  const std::size_t index = names.axis == name_of(Axis::Lat) ? 1 : 0;
  const std::string monitor = roles.monitor_of_controller();
  const sim::ServoAxis machine = sim::srmd_machine().axes[index];
  const auto named = [&](const std::string& name) { return word(run, ticks, name); };
  AxisEvidence result;
  result.index = index;
  result.limits = machine.limits;
  result.effective_mass = machine.effective_mass;
  result.command = named(names.command);
  result.reference = named(names.reference);
  result.echo = named(names.reference_echo);
  result.target = named(names.target);
  result.answer = named(names.returned_force);
  result.unlimited = named(monitor + "feed_forward.reference." + names.axis);
  result.limited = named(monitor + "limits.out." + names.axis);
  result.displacement = named(names.machine_displacement);
  result.acceleration = named(names.machine_acceleration);
  result.force = named(names.machine_force);
  result.specimen_force = named(names.force);
  if (!result.specimen_force.is_recorded()) result.specimen_force = result.force;
  result.sent_force = named(monitor + "target_force.force." + names.axis);
  if (!result.sent_force.is_recorded()) result.sent_force = result.specimen_force;
  result.largest_command = std::min(largest_magnitude(result.command.values), result.limits.stroke);
  return result;
}

// Counts without rows that are too many for an interpolation.
std::vector<TickSpan> gaps_in(const std::vector<double>& counter) {
  constexpr double kLongest = 10;  // [ticks]
  std::vector<TickSpan> gaps;
  double last = 0;
  for (const double count : counter) {
    if (last > 0 && count > last + kLongest)
      gaps.push_back({static_cast<std::size_t>(last), static_cast<std::size_t>(count)});
    last = std::max(last, count);
  }
  return gaps;
}

// Vertical load of the specimen in each tick: `rest_load` until the first reference, then the
// reference. A negative reference lifts the specimen off.
std::vector<double> loads_of(const Evidence& evidence, double rest_load) {
  std::vector<double> loads(evidence.time.size(), rest_load);
  if (!evidence.load_reference.is_recorded()) return loads;
  const auto& reference = evidence.load_reference.values;
  const auto first = std::ranges::find_if(reference, [](double load) { return load != 0; });
  for (auto i = static_cast<std::size_t>(first - reference.begin()); i < loads.size(); ++i)
    loads[i] = std::max(0.0, reference[i]);
  return loads;
}

// Moves the assumed model of the specimen as the platen was measured to move.
void add_model_force(Evidence& evidence, const Reader& run) {
  const std::string text = run.config(recording::kSpecimenText);
  if (text.empty()) return;
  const double rest_load = evidence.load.is_recorded() ? evidence.load.values.back() : 0;
  sim::BearingRun model{sim::read_bearing(Config::parse(text, recording::kSpecimenText), rest_load),
                        evidence.interval};
  const auto loads = loads_of(evidence, rest_load);
  std::array<std::vector<double>, sim::kHorizontalAxes> motion;
  for (auto& axis : evidence.axes) motion[axis.index] = smoothed(axis.displacement.values);
  for (std::size_t i = 0; i < evidence.time.size(); ++i) {
    Eigen::Vector2d displacement = Eigen::Vector2d::Zero(), velocity = displacement;
    for (const auto& axis : evidence.axes) {
      const auto& u = motion[axis.index];
      const auto at = static_cast<Eigen::Index>(axis.index);
      displacement[at] = u[i];
      velocity[at] = i == 0 ? 0 : (u[i] - u[i - 1]) / evidence.interval;
    }
    const Eigen::Vector2d force = model.advance(displacement, velocity, loads[i]);
    for (auto& axis : evidence.axes)
      axis.model_force.push_back(force[static_cast<Eigen::Index>(axis.index)]);
  }
}

}  // namespace

std::vector<TickSpan> windows(const Evidence& evidence, double length) {
  const auto ticks = static_cast<std::size_t>(length * evidence.rate / evidence.interval);
  const auto reach = static_cast<std::size_t>(kMotionSpan * evidence.rate / evidence.interval);
  const auto is_near = [&](const TickSpan& window) {
    return std::ranges::any_of(evidence.gaps, [&](const TickSpan& gap) {
      return gap.begin < window.end + reach && window.begin < gap.end + reach;
    });
  };
  std::vector<TickSpan> result;
  for (std::size_t begin = 0; ticks > 0 && begin + ticks <= evidence.time.size();
       begin += std::max<std::size_t>(1, ticks / 4))
    if (const TickSpan window{begin, begin + ticks}; !is_near(window)) result.push_back(window);
  return result;
}

std::span<const double> part(const std::vector<double>& values, const TickSpan& window) {
  return std::span{values}.subspan(window.begin, window.end - window.begin);
}

Proportion fit(std::span<const double> reference, std::span<const double> response) {
  const auto n = static_cast<double>(reference.size());
  const double mean_x = std::accumulate(reference.begin(), reference.end(), 0.0) / n;
  const double mean_y = std::accumulate(response.begin(), response.end(), 0.0) / n;
  double xx = 0, yy = 0, xy = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double x = reference[i] - mean_x, y = response[i] - mean_y;
    xx += x * x;
    yy += y * y;
    xy += x * y;
  }
  Proportion result;
  result.gain = xx > 0 ? xy / xx : 0;
  result.offset = mean_y - result.gain * mean_x;
  result.correlation = xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0;
  result.difference = std::sqrt(std::max(0.0, xx + yy - 2 * xy) / n);
  result.reference = std::sqrt(xx / n);
  result.response = std::sqrt(yy / n);
  return result;
}

Proportion fit_delayed(const RecordedSignal& reference, const RecordedSignal& response,
                       const TickSpan& window, std::size_t latest) {
  constexpr std::size_t kDelays = 20;
  const std::size_t stride = std::max<std::size_t>(1, latest / kDelays);
  const std::size_t length = window.end - window.begin;
  const std::size_t fitted = length > latest ? length - latest : 0;
  const TickSpan sent{window.begin, window.begin + fitted};
  Proportion best;
  for (std::size_t delay = 0; fitted > 0 && delay <= latest; delay += stride) {
    const Proportion f = fit(part(reference.values, sent),
                             part(response.values, {sent.begin + delay, sent.end + delay}));
    if (delay == 0 || f.difference < best.difference) best = f;
  }
  return best;
}

Proportion fit_copy(const RecordedSignal& reference, const RecordedSignal& response,
                    const TickSpan& window, std::size_t latest) {
  std::vector<double> aligned;
  for (std::size_t begin = window.begin; begin + kPiece + latest <= window.end; begin += kPiece) {
    const auto sent = part(reference.values, {begin, begin + kPiece});
    std::span<const double> closest;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t delay = 0; delay <= latest; ++delay) {
      const auto found = part(response.values, {begin + delay, begin + kPiece + delay});
      double apart = 0;
      for (std::size_t i = 0; i < kPiece; ++i) apart += std::abs(found[i] - sent[i]);
      if (apart < least) closest = found;
      least = std::min(least, apart);
    }
    aligned.insert(aligned.end(), closest.begin(), closest.end());
  }
  return fit(part(reference.values, {window.begin, window.begin + aligned.size()}), aligned);
}

Evidence gather(const Reader& run, const Config& experiment) {
  Evidence evidence;
  const Roles roles = recording::roles_of(run);
  for (const auto& node : {roles.machine, roles.controller})
    if (!run.has("monitor." + node + ".host.step")) return evidence;
  const NodeTicks ticks{run, roles.machine};
  evidence.time = at_each_count(ticks.counter(), run.time());
  evidence.time.resize(std::min(evidence.time.size(), ticks.count()));
  if (evidence.time.size() < 2) return evidence;
  evidence.interval = (evidence.time.back() - evidence.time.front()) /
                      static_cast<double>(evidence.time.size() - 1);
  evidence.rate = experiment.number("rate", 1.0);
  evidence.step = evidence.rate * experiment.number("integration_step_s", 0.01);
  if (!run.has(roles.new_target)) return evidence;
  const auto target = ticks.values(roles.new_target);
  evidence.rest = static_cast<std::size_t>(
      std::ranges::find_if(target, [](double flag) { return flag > 0; }) - target.begin());
  evidence.gaps = gaps_in(ticks.counter());
  evidence.load = word(run, ticks, roles.load);
  evidence.load_reference = word(run, ticks, roles.load_reference);
  for (const auto& names : roles.axes)
    if (run.has(names.command) && run.has(names.machine_displacement))
      evidence.axes.push_back(axis_of(run, ticks, roles, names));
  add_model_force(evidence, run);
  for (auto& axis : evidence.axes) {
    const auto& scale = axis.model_force.empty() ? axis.specimen_force.values : axis.model_force;
    axis.largest_force = std::min(largest_magnitude(scale), axis.limits.force);
  }
  return evidence;
}

}  // namespace rths::report
