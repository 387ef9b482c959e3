// SPDX-License-Identifier: Apache-2.0
#include "ticks.hpp"

#include <algorithm>
#include <cmath>

#include <rths/maths/bands.hpp>
#include <rths/maths/delay.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::report {
namespace {

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
  const auto [low, high] = std::minmax_element(command.begin(), command.end());
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
