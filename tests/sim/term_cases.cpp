// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rths::sim::test_support {
namespace {

struct Wave {
  double value = 0, rate = 0, acceleration = 0;
};

// Two sines that start at 0, so that the first step is small.
Wave wave(double amplitude, double frequency, double ratio, double t) {
  const double w = 2 * std::numbers::pi * frequency;
  const double a = 0.7 * amplitude, b = 0.3 * amplitude;
  return {a * std::sin(w * t) + b * std::sin(ratio * w * t),
          a * w * std::cos(w * t) + b * ratio * w * std::cos(ratio * w * t),
          -a * w * w * std::sin(w * t) - b * ratio * ratio * w * w * std::sin(ratio * w * t)};
}

TermCase made_up(const TermKind& kind) {
  TermCase c;
  c.kind = kind.name;
  if (kind.stage != Stage::Restoring && kind.stage != Stage::Vertical)
    c.companions = {lead_rubber()};
  return c;
}

}  // namespace

TermSettings lead_rubber() {
  return {"bouc_wen",
          "",
          {{"characteristic_strength", 1.01e6},
           {"post_yield_stiffness", 4.238e6},
           {"yield_displacement", 2.855e-3}}};
}

Quantities<double> motion_at(const Motion& motion, int i) {
  Quantities<double> q;
  q.time = i * motion.time_step;
  const Wave along = wave(motion.amplitude, motion.frequency, 3.7, q.time);
  const Wave across = wave(motion.amplitude, 0.83 * motion.frequency, 2.9, q.time);
  q.displacement = {along.value, across.value};
  q.velocity = {along.rate, across.rate};
  q.acceleration = {along.acceleration, across.acceleration};
  const Wave up = wave(1, 1.9 * motion.frequency, 1.7, q.time);
  q.axial_load = motion.axial_load * (1 + motion.axial_load_variation * up.value);
  q.vertical_displacement = motion.vertical_offset + motion.vertical_amplitude * up.value;
  q.vertical_velocity = motion.vertical_amplitude * up.rate;
  q.temperature = wave(motion.temperature, 0.3 * motion.frequency, 2.3, q.time).value;
  q.auxiliary = motion.auxiliary * (1 + wave(1, 0.7 * motion.frequency, 2.6, q.time).value);
  return q;
}

TermCase case_of(const TermKind& kind) {
  TermCase c = made_up(kind);
  for (const auto& group : {actuator_cases(), elastomeric_cases(), hysteresis_cases(),
                            machine_cases(), sensor_cases(), sliding_cases()})
    for (const auto& special : group)
      if (special.kind == kind.name) c = special;
  c.term.kind = kind.name;
  if (c.term.name.empty()) c.term.name = "tested";
  for (const auto& parameter : kind.parameters) {
    const auto given = std::any_of(c.term.parameters.begin(), c.term.parameters.end(),
                                   [&](const auto& pair) { return pair.first == parameter.name; });
    if (!given) c.term.parameters.emplace_back(parameter.name, parameter.typical);
  }
  return c;
}

Composition composition_of(const TermCase& c) {
  auto terms = c.companions;
  terms.push_back(c.term);
  return Composition{terms, c.motion.time_step};
}

template <class Real>
std::vector<Real> outputs_of(const Composition& composition, std::span<const Real> parameters,
                             const Motion& motion) {
  std::vector<Real> state(composition.states());
  std::vector<Real> outputs;
  outputs.reserve(static_cast<std::size_t>(motion.steps) * kOutputs);
  for (int i = 0; i < motion.steps; ++i) {
    const Quantities<double> given = motion_at(motion, i);
    Quantities<Real> q;
    q.time = given.time;
    for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis) {
      q.displacement[axis] = given.displacement[axis];
      q.velocity[axis] = given.velocity[axis];
      q.acceleration[axis] = given.acceleration[axis];
    }
    q.axial_load = given.axial_load;
    q.vertical_displacement = given.vertical_displacement;
    q.vertical_velocity = given.vertical_velocity;
    q.temperature = given.temperature;
    q.auxiliary = given.auxiliary;
    composition.advance(parameters, state, q);
    for (const auto& pair : {q.displacement, q.acceleration, q.force})
      outputs.insert(outputs.end(), pair.begin(), pair.end());
    outputs.push_back(q.axial_load);
  }
  return outputs;
}

template std::vector<double> outputs_of(const Composition&, std::span<const double>, const Motion&);
template std::vector<Dual> outputs_of(const Composition&, std::span<const Dual>, const Motion&);

}  // namespace rths::sim::test_support
