// SPDX-License-Identifier: Apache-2.0
//
// Conditions on the feedbacks among each other: displacement against acceleration, force against
// the force of the assumed model.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/maths/delay.hpp>
#include <rths/maths/statistics.hpp>

#include "analysis.hpp"
#include "conditions.hpp"

namespace rths::report {
namespace {

constexpr double kJudgedInertia = 0.05;  // of the platen, over the largest force
// The servo itself follows its reference: this decides which of two measurements is wrong.
constexpr double kServoDelay = 0.1;  // at most [s]
constexpr double kLeastServoGain = 0.55, kLargestServoGain = 1.25;
constexpr double kLeastCorrelation = 0.8;
constexpr double kExtreme = 0.97, kSaturation = 0.2;  // of the extreme; of the largest force
constexpr std::size_t kFewExtremes = 20;              // ticks
constexpr double kStrong = 0.1;  // of the largest force: windows with less are not judged
constexpr double kForceWindow = 1.0;

// x(t + T) − 2 x(t) + x(t − T): for a displacement, the acceleration weighted by a triangle.
std::vector<double> second_difference(const std::vector<double>& x, std::size_t span) {
  std::vector<double> result(x.size(), 0.0);
  for (std::size_t i = span; i + span < x.size(); ++i)
    result[i] = x[i + span] - 2 * x[i] + x[i - span];
  return result;
}

std::vector<double> integral(const std::vector<double>& x, double interval) {
  std::vector<double> result(x.size(), 0.0);
  for (std::size_t i = 1; i < x.size(); ++i)
    result[i] = result[i - 1] + (x[i - 1] + x[i]) / 2 * interval;
  return result;
}

// The measured force in a window beside that of the model under the measured motion.
Break force_in(const TickSpan& window, const AxisEvidence& axis, const Evidence& all,
               const Bounds& bounds) {
  const auto& measured = axis.specimen_force.values;
  const auto& model = axis.model_force;
  const double largest = axis.largest_force;
  const Proportion f = fit(part(model, window), part(measured, window));
  const double offset = maths::mean(part(measured, window)) - maths::mean(part(model, window));
  const Proportion moved =
      fit(part(axis.command.values, window), part(axis.displacement.values, window));
  const bool is_strong = std::max(f.reference, f.response) > kStrong * largest &&
                         std::max(moved.reference, moved.response) > 2 * bounds.resolution;
  const auto broken = [&](const std::string& found, const std::string& expected) {
    return Broken{"force", all.time[window.begin], axis.force.name, found, expected};
  };
  if (std::abs(offset) > bounds.force_offset * largest)
    return broken(fmt::format("an offset of {:.0f} kN from the model", 1e-3 * offset),
                  fmt::format("at most {:.0f} kN", 1e-3 * bounds.force_offset * largest));
  if (!is_strong) return {};
  if (f.correlation < kLeastCorrelation && f.correlation > 0.5)
    return broken(fmt::format("a correlation of {:.2f} with the force of the model", f.correlation),
                  fmt::format("at least {:g}", kLeastCorrelation));
  if (f.correlation < kLeastCorrelation || f.gain > bounds.force_factor ||
      f.gain < 1 / bounds.force_factor)
    return broken(proportion(f, "the force of the model"),
                  fmt::format("between {:.2g} and {:g} times the force of the model",
                              1 / bounds.force_factor, bounds.force_factor));
  return {};
}

// Measured force that stays at its extreme while the force of the model changes.
Break saturation_of(const AxisEvidence& axis, const Evidence& all, std::size_t end) {
  const auto& measured = axis.specimen_force.values;
  for (const double sign : {1.0, -1.0}) {
    double most = 0;
    for (std::size_t i = 0; i < end; ++i) most = std::max(most, sign * measured[i]);
    std::vector<double> model;
    std::size_t first = end;
    for (std::size_t i = 0; i < end; ++i)
      if (sign * measured[i] > kExtreme * most) {
        first = std::min(first, i);
        model.push_back(axis.model_force[i]);
      }
    if (model.size() < kFewExtremes) continue;
    const double change = maths::quantile(model, 0.95) - maths::quantile(model, 0.05);
    if (change > kSaturation * axis.largest_force)
      return Broken{
          "force", all.time[first], axis.force.name,
          fmt::format(
              "a force that stays at {:.0f} kN while that of the model changes by {:.0f} kN",
              sign * most * 1e-3, change * 1e-3),
          fmt::format("at most {:.0f} kN", kSaturation * axis.largest_force * 1e-3)};
  }
  return {};
}

}  // namespace

std::string proportion(const Proportion& f, const std::string& reference) {
  constexpr double kDead = 0.02, kRelated = 0.5;
  if (f.response < kDead * f.reference) return "constant, independent of " + reference;
  if (std::abs(f.correlation) < kRelated) return "unrelated to " + reference;
  return fmt::format("{:.3g} times {}{}", f.gain, reference,
                     f.gain < 0 ? ", with the opposite sign" : "");
}

std::optional<double> delay_of(const std::vector<double>& reference,
                               const std::vector<double>& response, const Evidence& all) {
  constexpr double kSearch = 0.25;  // [s]
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(all.rate)));
  std::vector<double> x, y;
  for (std::size_t i = 0; i < reference.size(); i += stride) {
    x.push_back(reference[i]);
    y.push_back(response[i]);
  }
  try {
    return maths::identify_delay(x, y, all.interval * static_cast<double>(stride),
                                 kSearch * all.rate)
        .cross_correlation;
  } catch (const Error&) {
    return std::nullopt;  // too short, or without motion
  }
}

Break motion_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds) {
  if (!axis.acceleration.is_recorded()) return {};
  const double span_s = kMotionSpan * all.rate;
  const auto span = static_cast<std::size_t>(std::lround(span_s / all.interval));
  const auto by_displacement = second_difference(axis.displacement.values, span);
  const auto by_acceleration = second_difference(
      integral(integral(axis.acceleration.values, all.interval), all.interval), span);
  const RecordedSignal referred{"", second_difference(axis.reference.values, span)};
  const auto servo_delay = static_cast<std::size_t>(kServoDelay / all.interval);
  // Below this acceleration, the inertia of the platen is small beside the force.
  const double judged = std::max(bounds.resolution, kJudgedInertia * axis.largest_force /
                                                        axis.effective_mass * span_s * span_s);
  for (const auto& window : windows(all, kForceWindow)) {
    const Proportion f = fit(part(by_acceleration, window), part(by_displacement, window));
    const double larger = std::max(f.reference, f.response);
    if (larger < judged) continue;
    if (f.difference <= bounds.motion * larger) continue;
    const auto is_plausible = [&](const std::vector<double>& motion) {
      const Proportion of_servo = fit_delayed(referred, {"", motion}, window, servo_delay);
      return of_servo.gain > kLeastServoGain && of_servo.gain < kLargestServoGain;
    };
    const bool blames_acceleration =
        !is_plausible(by_acceleration) && is_plausible(by_displacement);
    const auto& blamed = blames_acceleration ? axis.acceleration : axis.displacement;
    const auto& other = blames_acceleration ? axis.displacement : axis.acceleration;
    return Broken{
        "motion", all.time[window.begin], blamed.name,
        fmt::format("a difference of {:.0f} % from {}", 100 * f.difference / larger, other.name),
        fmt::format("at most {:g} %", 100 * bounds.motion)};
  }
  return {};
}

Break force_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds, double until) {
  if (axis.model_force.empty() || !axis.specimen_force.is_recorded()) return {};
  for (const auto& window : windows(all, kForceWindow)) {
    if (all.time[window.end - 1] > until) break;
    if (auto broken = force_in(window, axis, all, bounds)) return broken;
  }
  const auto end = static_cast<std::size_t>(
      std::ranges::find_if(all.time, [&](double time) { return time > until; }) - all.time.begin());
  if (auto saturated = saturation_of(axis, all, end)) return saturated;
  if (!std::isinf(until)) return {};
  const auto delay = delay_of(axis.model_force, axis.specimen_force.values, all);
  if (!delay || std::abs(*delay) <= bounds.force_delay * all.rate) return {};
  return Broken{"force", all.time.front(), axis.force.name,
                fmt::format("a delay of {:.1f} ms behind the motion", 1e3 * *delay),
                fmt::format("at most {:g} ms", 1e3 * bounds.force_delay * all.rate)};
}

}  // namespace rths::report
