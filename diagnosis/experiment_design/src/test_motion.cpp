// SPDX-License-Identifier: Apache-2.0
#include "test_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rths::diagnosis {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// From 0 to 1 within a time, without a corner at either end.
double rise(double t, double time) {
  const double x = std::clamp(t / time, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

}  // namespace

Index TestTime::samples() const { return static_cast<Index>(std::lround(duration / step)); }

VectorXd TestTime::elapsed() const {
  VectorXd t(samples());
  for (Index k = 0; k < t.size(); ++k) t[k] = std::max(0.0, static_cast<double>(k) * step - rest);
  return t;
}

VectorXd sine(const TestTime& time, double amplitude, double frequency, double phase) {
  return time.elapsed().unaryExpr([&](double t) {
    return amplitude * rise(t, 2 / frequency) * std::sin(kTurn * frequency * t + phase);
  });
}

VectorXd triangle(const TestTime& time, double amplitude, double velocity) {
  return time.elapsed().unaryExpr([&](double t) {
    const double quarters = t * velocity / amplitude;
    const double within = std::fmod(quarters + 1, 4);
    return amplitude * (within < 2 ? within - 1 : 3 - within);
  });
}

VectorXd staircase(const TestTime& time, double amplitude, double frequency, int steps) {
  const double length = time.moving() / steps;
  return time.elapsed().unaryExpr([&](double t) {
    double level = 0;
    for (int i = 0; i < steps; ++i) level += rise(t - i * length, 1 / frequency) / steps;
    return amplitude * level * std::sin(kTurn * frequency * t);
  });
}

VectorXd sweep(const TestTime& time, double amplitude, double from, double to) {
  const double growth = std::log(to / from) / time.moving();
  return time.elapsed().unaryExpr([&](double t) {
    const double turns = from * std::expm1(growth * t) / growth;
    return amplitude * rise(t, 1 / from) * std::sin(kTurn * turns);
  });
}

VectorXd ramps_and_holds(const TestTime& time, double amplitude, double velocity, double hold) {
  const double way = 2 * amplitude / velocity, half = way + hold;
  return time.elapsed().unaryExpr([&](double t) {
    const double first = way / 2;
    if (t < first) return velocity * t;
    const double phase = std::fmod(t - first, 2 * half);
    if (phase < hold) return amplitude;
    if (phase < half) return amplitude - velocity * (phase - hold);
    if (phase < half + hold) return -amplitude;
    return -amplitude + velocity * (phase - half - hold);
  });
}

VectorXd bursts(const TestTime& time, double amplitude, double frequency, int count) {
  const double length = time.moving() / count;
  const double moving = std::max(2.0, std::floor(length / 2 * frequency)) / frequency;
  return time.elapsed().unaryExpr([&](double t) {
    const double phase = std::fmod(t, length);
    const double window = rise(phase, 1 / frequency) * rise(moving - phase, 1 / frequency);
    return amplitude * window * std::sin(kTurn * frequency * phase);
  });
}

}  // namespace rths::diagnosis
