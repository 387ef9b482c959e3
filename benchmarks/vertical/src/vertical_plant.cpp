// SPDX-License-Identifier: Apache-2.0
#include "vertical_plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rths::bench {
namespace {

constexpr double kPeriod = 1e-3;
constexpr int kSubsteps = 10;
constexpr double kSlip = 1e-3;  // velocity at which friction is developed [m/s]

}  // namespace

VerticalMachine draw_vertical(int seed) {
  VerticalMachine machine;
  if (seed == 0) return machine;
  std::mt19937_64 random{static_cast<std::uint64_t>(seed)};
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  };
  machine.bulk_modulus *= uniform(0.8, 1.2);
  machine.valve_frequency *= uniform(0.85, 1.15);
  machine.dead_band = uniform(0.005, 0.02);
  machine.friction *= uniform(0.5, 1.5);
  machine.stiffness *= uniform(0.9, 1.1);
  machine.softening *= uniform(0.9, 1.1);
  machine.lift_radius *= uniform(0.9, 1.1);
  return machine;
}

VerticalRun::VerticalRun(const VerticalMachine& machine, double preload, std::uint64_t seed)
    : machine_{machine}, force_{preload}, random_{seed} {
  state_.x = preload / machine.stiffness;
  state_.pressure = preload / machine.area;
  // The reference at which the machine rests under the preload.
  const double w = machine.leakage * state_.pressure / machine.rated_flow /
                   std::sqrt(1 - state_.pressure / machine.supply);
  state_.spool = w + machine.dead_band;
  const double reference =
      state_.x + (state_.spool + machine.pressure_gain * state_.pressure / machine.supply) *
                     machine.rated_flow / (machine.area * machine.position_gain);
  delay_.assign(static_cast<std::size_t>(std::lround(machine.transport / kPeriod * kSubsteps)),
                reference);
}

double VerticalRun::bearing_force(const State& s, double u) const {
  const double stiffness = machine_.stiffness / (1 + machine_.softening * u * u);
  return stiffness * (s.x - u * u / (2 * machine_.lift_radius)) + machine_.viscosity * s.v;
}

VerticalRun::State VerticalRun::rates(const State& s, double reference, double u) const {
  const VerticalMachine& m = machine_;
  const double demand = std::clamp(m.position_gain * (reference - s.x) * m.area / m.rated_flow -
                                       m.pressure_gain * s.pressure / m.supply,
                                   -1.0, 1.0);
  const double opening =
      std::abs(s.spool) > m.dead_band ? s.spool - std::copysign(m.dead_band, s.spool) : 0;
  const double drop = std::max(0.0, 1 - std::copysign(s.pressure, opening * s.pressure) / m.supply);
  const double flow = m.rated_flow * opening * std::sqrt(drop);
  const double omega = 2 * std::numbers::pi * m.valve_frequency;
  const double friction = m.friction * std::tanh(s.v / kSlip);
  return {s.v, (m.area * s.pressure - bearing_force(s, u) - friction) / m.mass,
          4 * m.bulk_modulus / m.volume * (flow - m.area * s.v - m.leakage * s.pressure),
          s.spool_rate,
          omega * omega * (demand - s.spool) - 2 * m.valve_damping * omega * s.spool_rate};
}

void VerticalRun::step(double reference, double horizontal) {
  const auto moved = [](const State& from, const State& d, double dt) {
    return State{from.x + dt * d.x, from.v + dt * d.v, from.pressure + dt * d.pressure,
                 from.spool + dt * d.spool, from.spool_rate + dt * d.spool_rate};
  };
  const double h = kPeriod / kSubsteps;
  const double before = horizontal_;
  for (int k = 0; k < kSubsteps; ++k) {
    const auto u = [&](double part) {
      return before + (horizontal - before) * (k + part) / kSubsteps;
    };
    const double delayed = delay_[head_];
    delay_[head_] = reference;
    head_ = (head_ + 1) % delay_.size();
    State& s = state_;
    const State k1 = rates(s, delayed, u(0));
    const State k2 = rates(moved(s, k1, h / 2), delayed, u(0.5));
    const State k3 = rates(moved(s, k2, h / 2), delayed, u(0.5));
    const State k4 = rates(moved(s, k3, h), delayed, u(1));
    s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
    s.spool = std::clamp(s.spool, -1.0, 1.0);
    s.pressure = std::clamp(s.pressure, -machine_.supply, machine_.supply);
  }
  horizontal_ = horizontal;
  force_ = bearing_force(state_, horizontal);
}

}  // namespace rths::bench
