// SPDX-License-Identifier: Apache-2.0
//
// [targets]: displacements imposed in place of an analysis.
#include "tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/loop/numerical_response.hpp>
#include <rths/sim/motion_file.hpp>

namespace rths::experiment {
namespace {

constexpr double kTaper = 1.0;           // at the start and end of sweeps and noise [s]
constexpr double kHighestTarget = 20.0;  // [Hz]
using PerAxis = std::array<double, 2>;   // long, lat

PerAxis read_pair(const Config& table, const std::string& key) {
  const auto values = table.numbers(key);
  if (values.size() != 2)
    table.fail(key, fmt::format("{} has {} numbers, expected two: long, lat", key, values.size()));
  for (const double value : values)
    if (!(value >= 0 && value <= 10))
      table.fail(key, fmt::format("{} is {}, expected 0 to 10", key, value));
  return {values[0], values[1]};
}

/// Largest displacement and speed of a commanded motion.
struct Reach {
  PerAxis amplitude{}, speed{};
  explicit Reach(const Config& table)
      : amplitude{read_pair(table, "amplitude_m")}, speed{read_pair(table, "velocity_m_per_s")} {}
  [[nodiscard]] double at(std::size_t axis, double frequency) const {
    return std::min(amplitude[axis], speed[axis] / (2 * std::numbers::pi * frequency));
  }
};

// Rises smoothly from 0 to 1 over `length`, and falls at the end.
double taper(double time, double duration, double length) {
  const double inside = std::clamp(std::min(time, duration - time) / length, 0.0, 1.0);
  return 0.5 * (1 - std::cos(std::numbers::pi * inside));
}

DisplacementHistory empty_history(const Experiment& experiment) {
  DisplacementHistory history;
  history.time_step = experiment.time.integration_step;
  const auto steps = static_cast<std::size_t>(std::llround(experiment.time.duration /
                                                           experiment.time.integration_step)) +
                     1;
  history.displacement_long.assign(steps, 0);
  history.displacement_lat.assign(steps, 0);
  return history;
}

std::vector<double>& of_axis(DisplacementHistory& history, std::size_t axis) {
  return axis == 0 ? history.displacement_long : history.displacement_lat;
}

// Bursts of a sine, one frequency after the other; lat is a quarter of a cycle behind.
DisplacementHistory harmonic(const Config& table, const Experiment& experiment) {
  const auto frequencies = table.numbers("frequencies_Hz");
  const double cycles = static_cast<double>(table.integer_in("cycles", 3, 1000, 6));
  const Reach reach{table};
  DisplacementHistory history = empty_history(experiment);
  double begin = 0;
  for (const double frequency : frequencies) {
    if (!(frequency >= 0.01 && frequency <= kHighestTarget))
      table.fail("frequencies_Hz", fmt::format("frequencies_Hz has {}, expected 0.01 to {}",
                                               frequency, kHighestTarget));
    const double length = cycles / frequency;
    for (std::size_t axis = 0; axis < 2; ++axis)
      for (std::size_t i = 0; i < history.displacement_long.size(); ++i) {
        const double t = static_cast<double>(i) * history.time_step - begin;
        if (t <= 0 || t >= length) continue;
        const double phase =
            2 * std::numbers::pi * (frequency * t - 0.25 * static_cast<double>(axis));
        of_axis(history, axis)[i] =
            reach.at(axis, frequency) * taper(t, length, 1 / frequency) * std::sin(phase);
      }
    begin += length;
  }
  if (begin > experiment.time.duration)
    table.fail("frequencies_Hz", fmt::format("the bursts take {:.3g} s, duration_s is {:.3g}",
                                             begin, experiment.time.duration));
  return history;
}

std::pair<double, double> read_band(const Config& table) {
  const double from = table.number_in("from_Hz", 0.01, kHighestTarget);
  const double to = table.number_in("to_Hz", 0.01, kHighestTarget);
  if (!(to > from))
    table.fail("to_Hz", fmt::format("to_Hz is {}, expected more than {}", to, from));
  return {from, to};
}

// A sine whose frequency grows exponentially. Along lat it falls, so that the axes differ.
DisplacementHistory sweep(const Config& table, const Experiment& experiment) {
  const auto [from, to] = read_band(table);
  const Reach reach{table};
  DisplacementHistory history = empty_history(experiment);
  const double rate = std::log(to / from) / experiment.time.duration;
  for (std::size_t i = 0; i < history.displacement_long.size(); ++i) {
    const double time = static_cast<double>(i) * history.time_step;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double t = axis == 0 ? time : experiment.time.duration - time;
      const double frequency = from * std::exp(rate * t);
      of_axis(history, axis)[i] = reach.at(axis, frequency) *
                                  taper(time, experiment.time.duration, kTaper) *
                                  std::sin(2 * std::numbers::pi * (frequency - from) / rate);
    }
  }
  return history;
}

// Sines of all frequencies of the record's length in a band, of equal speed and random phase.
DisplacementHistory noise(const Config& table, const Experiment& experiment, std::uint64_t seed) {
  const auto [from, to] = read_band(table);
  const PerAxis rms = read_pair(table, "rms_m");
  DisplacementHistory history = empty_history(experiment);
  std::mt19937_64 random{seed};
  std::uniform_real_distribution<double> phase{0, 2 * std::numbers::pi};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    auto& x = of_axis(history, axis);
    for (double n = std::ceil(from * experiment.time.duration); n <= to * experiment.time.duration;
         ++n) {
      const double start = phase(random);
      for (std::size_t i = 0; i < x.size(); ++i)
        x[i] += std::sin(2 * std::numbers::pi * n * static_cast<double>(i) /
                             static_cast<double>(x.size() - 1) +
                         start) /
                n;
    }
    double squares = 0;
    for (const double value : x) squares += value * value;
    const double scale =
        squares > 0 ? rms[axis] / std::sqrt(squares / static_cast<double>(x.size())) : 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] *= scale *
              taper(static_cast<double>(i) * history.time_step, experiment.time.duration, kTaper);
  }
  return history;
}

// The response after a number of reference steps; its first value is that after one. A whole number
// within rounding errors needs no interpolation.
double value_at(const std::vector<double>& response, double steps) {
  const double whole = std::round(steps);
  if (std::abs(steps - whole) < 1e-6) steps = whole;
  const double last = static_cast<double>(response.size());
  const double before = std::min(std::floor(steps), last), after = std::min(before + 1, last);
  const auto value = [&](double at) {
    return at < 1 ? 0.0 : response[static_cast<std::size_t>(at) - 1];
  };
  return value(before) + (steps - std::floor(steps)) * (value(after) - value(before));
}

// Displacements of a table with a file: columns [m], scaled; the first row is the start.
DisplacementHistory read_displacements(const Config& table) {
  const auto file = table.resolve(table.text("file"));
  const double scale = table.number_in("scale", -100, 100, 1.0);
  DisplacementHistory history;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const std::string key = axis == 0 ? "column_long" : "column_lat";
    const auto read =
        sim::read_column(file, static_cast<int>(table.integer_in(key, 1, 100, axis == 0 ? 1 : 2)));
    history.time_step = read.time_step;
    for (const double value : read.values) of_axis(history, axis).push_back(scale * value);
  }
  return history;
}

// The motion that a test is expected to have: that of the purely numerical result.
DisplacementHistory expected_motion(const Experiment& experiment) {
  const auto response =
      loop::numerical_response(*experiment.plant.structure, experiment.tested_motion(),
                               experiment.model.bearing, kReferenceStep, experiment.time.duration);
  DisplacementHistory history = empty_history(experiment);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto& found = axis == 0 ? response.displacement_long : response.displacement_lat;
    auto& wanted = of_axis(history, axis);
    for (std::size_t i = 1; i < wanted.size(); ++i)
      wanted[i] = value_at(
          found, static_cast<double>(i) * experiment.time.integration_step / kReferenceStep);
  }
  return history;
}

}  // namespace

DisplacementHistory read_targets(const Config& table, const Experiment& experiment,
                                 std::uint64_t seed) {
  const std::string kind = table.text("kind");
  DisplacementHistory history;
  if (kind == "harmonic")
    history = harmonic(table, experiment);
  else if (kind == "sweep")
    history = sweep(table, experiment);
  else if (kind == "noise")
    history = noise(table, experiment, seed);
  else if (kind == "response")
    history = expected_motion(experiment);
  else if (kind == "file")
    history = read_displacements(table);
  else
    table.fail(
        "kind",
        fmt::format("kind is '{}', expected harmonic, sweep, noise, response or file", kind));
  table.reject_unknown_keys();
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (!contains(experiment.axes, kHorizontal[axis]))
      std::fill(of_axis(history, axis).begin(), of_axis(history, axis).end(), 0.0);
  return history;
}

DisplacementHistory read_reference(const Config& table) {
  auto reference = read_displacements(table);
  table.reject_unknown_keys();
  return reference;
}

}  // namespace rths::experiment
