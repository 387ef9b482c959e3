// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/loop_test.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

struct Sine {
  double value, rate, acceleration;
};

// amplitude·g(t)·sin(ωt), where g grows smoothly from 0 to 1 within `growth_time`.
Sine grown_sine(double amplitude, double omega, double growth_time, double t) {
  const double phase = std::numbers::pi * std::clamp(t / growth_time, 0.0, 1.0);
  const bool grows = t < growth_time;
  const double phase_rate = std::numbers::pi / growth_time;
  const double g = 0.5 * (1 - std::cos(phase));
  const double dg = grows ? 0.5 * phase_rate * std::sin(phase) : 0;
  const double ddg = grows ? 0.5 * phase_rate * phase_rate * std::cos(phase) : 0;
  const double s = std::sin(omega * t), c = omega * std::cos(omega * t);
  return {amplitude * g * s, amplitude * (dg * s + g * c),
          amplitude * (ddg * s + 2 * dg * c - g * omega * omega * s)};
}

Quantities<double> given(const Bearing& bearing, const LoopTest& test, double t) {
  const double omega = 2 * std::numbers::pi * test.frequency;
  const double growth = 1 / test.frequency;
  const Sine along = grown_sine(test.amplitude_long, omega, growth, t);
  const Sine across = grown_sine(test.amplitude_lat, 2 * omega, growth, t);
  // Load and vertical motion are not synchronous with the horizontal motion.
  const Sine up = grown_sine(1, 1.3 * omega, growth, t);
  Quantities<double> q;
  q.time = t;
  q.displacement = {along.value, across.value};
  q.velocity = {along.rate, across.rate};
  q.acceleration = {along.acceleration, across.acceleration};
  q.axial_load = bearing.axial_load * (1 + test.axial_load_variation * up.value);
  q.vertical_displacement = test.vertical_offset + test.vertical_amplitude * up.value;
  q.vertical_velocity = test.vertical_amplitude * up.rate;
  q.temperature = bearing.temperature;
  q.auxiliary = test.auxiliary;
  return q;
}

int steps_per_cycle(const LoopTest& test) {
  return static_cast<int>(std::lround(1 / (test.frequency * test.time_step)));
}

constexpr double kUsualStep = 1e-3;  // [s]
constexpr double kFewestSteps = 1'000, kMostSteps = 20'000;

// The numbers of the steps behind `first`, to `last`.
CycleNumbers numbers_of_cycle(const LoopHistory& history, std::size_t first, std::size_t last) {
  const auto& u = history.displacement_long;
  const auto& v = history.displacement_lat;
  const auto& f = history.force_long;
  const auto& g = history.force_lat;
  CycleNumbers cycle;
  std::size_t highest = first, lowest = first;
  double crossings = 0, sum = 0;
  for (std::size_t i = first + 1; i <= last; ++i) {
    cycle.peak_force = std::max(cycle.peak_force, std::abs(f[i]));
    cycle.energy +=
        0.5 * (f[i] + f[i - 1]) * (u[i] - u[i - 1]) + 0.5 * (g[i] + g[i - 1]) * (v[i] - v[i - 1]);
    if (u[i] > u[highest]) highest = i;
    if (u[i] < u[lowest]) lowest = i;
    if ((u[i] > 0) == (u[i - 1] > 0)) continue;
    const double fraction = u[i - 1] / (u[i - 1] - u[i]);
    sum += std::abs(f[i - 1] + fraction * (f[i] - f[i - 1]));
    ++crossings;
  }
  if (crossings > 0) cycle.strength = sum / crossings;
  if (u[highest] > u[lowest])
    cycle.effective_stiffness = (f[highest] - f[lowest]) / (u[highest] - u[lowest]);
  return cycle;
}

}  // namespace

double time_step_of(double frequency) {
  return 1 / (frequency * std::clamp(1 / (frequency * kUsualStep), kFewestSteps, kMostSteps));
}

LoopHistory run_loop_test(const Bearing& bearing, const LoopTest& test) {
  if (test.cycles < 1 || !(test.frequency > 0) || !(test.time_step > 0) ||
      steps_per_cycle(test) < 20)
    throw Error{"loop test: expected at least one cycle of at least 20 steps"};
  if (test.vertical_offset == 0 && test.vertical_amplitude == 0) require_given_load(bearing);
  // A cycle is a whole number of steps, as `cycle_numbers` assumes.
  const double step = 1 / (test.frequency * steps_per_cycle(test));
  const Composition composition{bearing.terms, step};
  std::vector<double> state(composition.states());
  LoopHistory history;
  const int steps = test.cycles * steps_per_cycle(test);
  for (int i = 0; i <= steps; ++i) {
    Quantities<double> q = given(bearing, test, i * step);
    history.command_long.push_back(q.displacement[0]);
    composition.advance(state, q);
    history.time.push_back(q.time);
    history.displacement_long.push_back(q.displacement[0]);
    history.displacement_lat.push_back(q.displacement[1]);
    history.acceleration_long.push_back(q.acceleration[0]);
    history.force_long.push_back(q.force[0]);
    history.force_lat.push_back(q.force[1]);
    history.vertical_displacement.push_back(q.vertical_displacement);
    history.axial_load.push_back(q.axial_load);
  }
  return history;
}

std::vector<CycleNumbers> cycle_numbers(const LoopHistory& history, const LoopTest& test) {
  std::vector<CycleNumbers> cycles;
  const auto length = static_cast<std::size_t>(steps_per_cycle(test));
  const std::size_t size = history.force_long.size();
  for (std::size_t first = length; first + length < size; first += length)
    cycles.push_back(numbers_of_cycle(history, first, first + length));
  return cycles;
}

}  // namespace rths::sim
