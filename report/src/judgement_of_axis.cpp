// SPDX-License-Identifier: Apache-2.0
//
// Conditions on the machine: limits, references, tracking and each feedback by itself.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <rths/maths/statistics.hpp>

#include "analysis.hpp"
#include "conditions.hpp"

namespace rths::report {
namespace {

constexpr double kSecond = 1.0;          // windows of most conditions, in model time [s]
constexpr double kTrackingWindow = 2.0;  // [s]
constexpr double kShortestRest = 0.2;    // that shows an offset [s]
constexpr double kFollows = 0.9;         // correlation of a displacement that has only an offset
constexpr double kNormal = 0.6745;       // median magnitude of a normal variable over its deviation
constexpr double kLeastForce = 0.1;      // scale of forces, over the limit of the machine
constexpr double kLeastMotion = 20;      // scale of displacements, over the resolution
constexpr double kReferenceRounding = 1e-5;  // of a recorded reference [m]
constexpr std::size_t kSpeedReach = 10;      // ticks to either side

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(std::min(a.size(), b.size()));
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

// First tick at which a value is beyond a limit.
std::optional<std::size_t> first_beyond(const std::vector<double>& values, double limit) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::abs(values[i]) > limit) return i;
  return std::nullopt;
}

// Departure of each value from the mean of its neighbours; 0 for the first and the last.
std::vector<double> bends(const std::vector<double>& values) {
  std::vector<double> result(values.size(), 0.0);
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    result[i] = values[i] - (values[i - 1] + values[i + 1]) / 2;
  return result;
}

// Standard deviation of white noise from the bends, √1.5 of it; robust to a few outliers.
double noise_in(std::span<const double> bends) {
  std::vector<double> sizes;
  for (const double bend : bends) sizes.push_back(std::abs(bend));
  return maths::quantile(std::move(sizes), 0.5) / kNormal / std::sqrt(1.5);
}

// Total time of the ticks at a limit.
template <class IsAtLimit>
Break at_limit(const RecordedSignal& word, const Evidence& all, const Bounds& bounds,
               IsAtLimit is_at_limit, const std::string& limit) {
  std::size_t ticks = 0, first = 0;
  for (std::size_t i = 0; i < word.values.size(); ++i) {
    if (!is_at_limit(word.values[i], i)) continue;
    if (ticks++ == 0) first = i;
  }
  const double duration = static_cast<double>(ticks) * all.interval;
  if (ticks == 0 || duration <= bounds.at_limits) return {};
  return Broken{"limit", all.time[first], word.name,
                fmt::format("{} for {:.3f} s", limit, duration),
                fmt::format("at most {:g} s", bounds.at_limits)};
}

}  // namespace

Break limit_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds) {
  const auto most = [&](const RecordedSignal& word, double limit, double unit, const char* name) {
    return at_limit(
        word, all, bounds, [=](double value, std::size_t) { return std::abs(value) >= limit; },
        fmt::format("{:g} {} or more", limit * unit, name));
  };
  if (auto stroke = most(axis.displacement, axis.limits.stroke, 1, "m")) return stroke;
  if (auto force = most(axis.force, axis.limits.force, 1e-3, "kN")) return force;
  if (!axis.unlimited.is_recorded()) return {};
  return at_limit(
      axis.limited, all, bounds,
      [&](double value, std::size_t i) {
        return std::abs(axis.unlimited.values[i] - value) > kReferenceRounding;
      },
      "the limit of the controller");
}

std::vector<Wire> wires_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds) {
  constexpr std::size_t kTransfer = 3;  // ticks
  constexpr double kHold = 0.3;         // a value held for a step differs from its source
  const auto step = static_cast<std::size_t>(std::lround(2 * all.step / all.interval));
  const double force = kLeastForce * axis.limits.force;
  std::vector<Wire> wires;
  for (const Wire& wire :
       {Wire{&axis.reference, &axis.echo, kTransfer, true, bounds.motion, bounds.resolution},
        Wire{&axis.target, &axis.command, step, false, kHold, 2 * bounds.resolution},
        Wire{&axis.sent_force, &axis.answer, step, false, kHold, force}})
    if (wire.from->is_recorded() && wire.to->is_recorded()) wires.push_back(wire);
  return wires;
}

Break wire_of(const Wire& wire, const Evidence& all) {
  for (const auto& window : windows(all, kSecond)) {
    if (window.end - window.begin <= 2 * wire.latest) return {};
    const Proportion best =
        (wire.is_copy ? fit_copy : fit_delayed)(*wire.from, *wire.to, window, wire.latest);
    const double larger = std::max(best.reference, best.response);
    if (larger <= wire.least || best.difference <= wire.bound * larger) continue;
    return Broken{"wire", all.time[window.begin], wire.to->name, proportion(best, wire.from->name),
                  "the same values"};
  }
  return {};
}

Break tracking_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds) {
  const auto& u = axis.command.values;
  const auto& d = axis.displacement.values;
  const auto error = difference(d, u);
  const double largest = axis.largest_command;
  const auto allowed = [&](double bound) { return std::max(bound * largest, bounds.resolution); };
  // Without a command, an error has no fraction.
  const auto found_as = [&](double size) {
    return largest > 0 ? fmt::format("{:.1f} %", 100 * size / largest)
                       : fmt::format("{:.1f} mm", 1e3 * size);
  };
  const auto allowed_as = [&](double bound) {
    return largest > 0 ? fmt::format("at most {:g} %", 100 * bound)
                       : fmt::format("at most {:g} mm", 1e3 * allowed(bound));
  };
  for (const auto& window : windows(all, kTrackingWindow)) {
    const double found = maths::rms(part(error, window));
    if (found > allowed(bounds.window_nrms))
      return Broken{"tracking", all.time[window.begin], axis.displacement.name,
                    fmt::format("an RMS error of {} in 2 s, {}", found_as(found),
                                proportion(fit(part(u, window), part(d, window)), "the command")),
                    allowed_as(bounds.window_nrms)};
  }
  if (maths::rms(error) > allowed(bounds.nrms))
    return Broken{"tracking", all.time.front(), axis.displacement.name,
                  fmt::format("an RMS error of {}", found_as(maths::rms(error))),
                  allowed_as(bounds.nrms)};
  if (const auto delay = delay_of(u, d, all); delay && largest > 10 * bounds.resolution) {
    if (std::abs(*delay) > bounds.delay * all.rate)
      return Broken{"tracking", all.time.front(), axis.displacement.name,
                    fmt::format("a delay of {:.1f} ms", 1e3 * *delay),
                    fmt::format("at most {:g} ms", 1e3 * bounds.delay * all.rate)};
  }
  return {};
}

Break offset_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds) {
  const auto& d = axis.displacement;
  const auto error = difference(d.values, axis.command.values);
  const auto beyond = [&](const TickSpan& window, double allowed) -> Break {
    const double offset = maths::mean(part(error, window));
    if (std::abs(offset) <= allowed) return {};
    return Broken{"offset", all.time[window.begin], d.name,
                  fmt::format("an offset of {:.1f} mm from the command", 1e3 * offset),
                  fmt::format("at most {:.1f} mm", 1e3 * allowed)};
  };
  if (static_cast<double>(all.rest) * all.interval > kShortestRest)
    if (auto at_rest = beyond({0, all.rest}, bounds.resolution)) return at_rest;
  const double allowed = std::max(bounds.offset * axis.largest_command, 2 * bounds.resolution);
  for (const auto& window : windows(all, kTrackingWindow)) {
    const Proportion f = fit(part(axis.command.values, window), part(d.values, window));
    const bool is_still = std::max(f.reference, f.response) < bounds.resolution;
    if (!is_still && f.correlation < kFollows) continue;
    if (auto broken = beyond(window, allowed)) return broken;
  }
  return {};
}

Break load_limit_of(const Evidence& all) {
  const auto& load = all.load_reference.values;
  const auto most = std::ranges::max_element(load);
  if (most == load.end() || *most <= sim::kVerticalCapacity) return {};
  const auto first =
      std::ranges::find_if(load, [](double value) { return value > sim::kVerticalCapacity; });
  return Broken{
      "limit", all.time[static_cast<std::size_t>(first - load.begin())], all.load_reference.name,
      fmt::format("up to {:.4g} MN, which the machine clamps", *most * 1e-6),
      fmt::format("at most {:g} MN, its vertical capacity", sim::kVerticalCapacity * 1e-6)};
}

Break load_of(const Evidence& all, const Bounds& bounds) {
  if (!all.load.is_recorded() || !all.load_reference.is_recorded()) return {};
  for (const auto& window : windows(all, kSecond)) {
    const double load = maths::mean(part(all.load.values, window));
    const double reference = maths::mean(part(all.load_reference.values, window));
    if (std::abs(load - reference) <= bounds.load * std::abs(reference)) continue;
    return Broken{"load", all.time[window.begin], all.load.name,
                  fmt::format("{:.0f} kN", load * 1e-3),
                  fmt::format("{:.0f} kN", reference * 1e-3)};
  }
  return {};
}

std::vector<Feedback> feedbacks_of(const AxisEvidence& axis, const Bounds& bounds) {
  const double force = std::max(axis.largest_force, kLeastForce * axis.limits.force);
  std::vector<Feedback> result;
  for (const auto& feedback :
       {Feedback{&axis.displacement, &axis.command.values,
                 std::max(axis.largest_command, kLeastMotion * bounds.resolution),
                 bounds.displacement_jump},
        Feedback{&axis.force, &axis.command.values, force, bounds.force_jump},
        Feedback{&axis.acceleration, &axis.command.values, force / axis.effective_mass,
                 bounds.force_jump}})
    if (feedback.word->is_recorded()) result.push_back(feedback);
  return result;
}

// The samples are unchanged while the command moves.
Break frozen_of(const Feedback& feedback, const Evidence& all, const Bounds& bounds) {
  const auto& w = feedback.word->values;
  const auto& u = *feedback.expected;
  const double moved = std::max(0.02 * largest_magnitude(u), bounds.resolution);
  std::size_t start = 0;
  for (std::size_t i = 1; i <= w.size(); ++i) {
    if (i < w.size() && w[i] == w[start]) continue;
    const std::size_t begin = std::exchange(start, i);
    if (i - begin <= 20) continue;
    const auto [low, high] = std::minmax_element(u.begin() + static_cast<std::ptrdiff_t>(begin),
                                                 u.begin() + static_cast<std::ptrdiff_t>(i));
    if (*high - *low > moved)
      return Broken{"live", all.time[begin], feedback.word->name,
                    fmt::format("frozen for {:.3f} s while the command moves by {:.1f} mm",
                                all.time[i - 1] - all.time[begin], 1e3 * (*high - *low)),
                    "a new value in each step"};
  }
  return {};
}

// The smallest change between two samples: the step of the sensor. 0: no change.
double smallest_change(const std::vector<double>& w) {
  double step = 0;
  for (std::size_t i = 1; i < w.size(); ++i)
    if (const double change = std::abs(w[i] - w[i - 1]); change > 0)
      step = step > 0 ? std::min(step, change) : change;
  return step;
}

// Too few new samples while the feedback changes.
Break repeated_of(const Feedback& feedback, const Evidence& all, const Bounds& bounds) {
  const auto& w = feedback.word->values;
  const double step = smallest_change(w);
  if (step == 0) return {};
  for (const auto& window : windows(all, kSecond)) {
    double judged = 0, repeated = 0;
    for (std::size_t i = std::max(window.begin, kSpeedReach + 1); i + kSpeedReach < window.end;
         ++i) {
      const double speed = std::abs(w[i + kSpeedReach] - w[i - kSpeedReach]) / (2 * kSpeedReach);
      if (speed < 2 * step) continue;
      ++judged;
      repeated += w[i] == w[i - 1] ? 1 : 0;
    }
    if (judged < 100) continue;
    if (repeated > bounds.repeated * judged)
      return Broken{
          "live", all.time[window.begin], feedback.word->name,
          fmt::format("{:.0f} % of the samples repeat the one before", 100 * repeated / judged),
          fmt::format("at most {:g} %", 100 * bounds.repeated)};
  }
  return {};
}

Break live_of(const Feedback& feedback, const Evidence& all, const Bounds& bounds) {
  if (auto frozen = frozen_of(feedback, all, bounds)) return frozen;
  return repeated_of(feedback, all, bounds);
}

Break jump_of(const Feedback& feedback, const Evidence& all) {
  const auto& w = feedback.word->values;
  const auto bend = bends(w);
  const double allowed = std::max(feedback.jump * feedback.scale, 12 * noise_in(bend));
  const auto at = first_beyond(bend, allowed);
  if (!at || feedback.scale <= 0) return {};
  return Broken{"jump", all.time[*at], feedback.word->name,
                fmt::format("{:.4g} between {:.4g} and {:.4g}", w[*at], w[*at - 1], w[*at + 1]),
                fmt::format("at most {:.3g} from their mean", allowed)};
}

Break noise_of(const Feedback& feedback, const Evidence& all, const Bounds& bounds) {
  const auto bend = bends(feedback.word->values);
  for (const auto& window : windows(all, kSecond)) {
    const double noise = noise_in(part(bend, window));
    if (noise <= bounds.noise * feedback.scale || feedback.scale <= 0) continue;
    return Broken{"noise", all.time[window.begin], feedback.word->name,
                  fmt::format("a standard deviation of {:.3g}", noise),
                  fmt::format("at most {:.3g}", bounds.noise * feedback.scale)};
  }
  return {};
}

}  // namespace rths::report
