// SPDX-License-Identifier: Apache-2.0
#include "shaking.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace rths::bench {
namespace {

constexpr int kWaves = 40;
constexpr double kLowest = 0.2, kHighest = 8;  // [Hz]
constexpr double kLoadVariation = 0.8;         // [-]

// A sum of sines. Above 0.7 Hz their displacements fall with the square of the frequency, as in an
// isolated building. Scaled to about ±1.
class Wave {
 public:
  explicit Wave(std::uint64_t seed) {
    std::mt19937_64 engine{seed};
    double square = 0;
    for (int i = 0; i < kWaves; ++i) {
      const double f = kLowest * std::pow(kHighest / kLowest, i / (kWaves - 1.0));
      const double size = 1 / (1 + std::pow(f / 0.7, 2));
      const double phase = static_cast<double>(engine() >> 11U) * 0x1p-53 * 2 * std::numbers::pi;
      sines_.push_back({2 * std::numbers::pi * f, size, phase});
      square += size * size / 2;
    }
    for (auto& sine : sines_) sine.size /= 3 * std::sqrt(square);
  }
  [[nodiscard]] double at(double t) const {
    double sum = 0;
    for (const auto& sine : sines_) sum += sine.size * std::sin(sine.rate * t + sine.phase);
    return sum;
  }
  [[nodiscard]] double rate_at(double t) const {
    double sum = 0;
    for (const auto& sine : sines_)
      sum += sine.size * sine.rate * std::cos(sine.rate * t + sine.phase);
    return sum;
  }

 private:
  struct Sine {
    double rate, size, phase;
  };
  std::vector<Sine> sines_;
};

void load(sim::Quantities<double>& q, const Demand& demand, double factor) {
  q.axial_load = demand.axial_load * factor;
  q.vertical_displacement = -q.axial_load / demand.vertical_stiffness;
}

}  // namespace

Shaking earthquake(const Demand& demand, int steps) {
  const Wave waves[] = {Wave{1}, Wave{2}};
  const Wave vertical{3};
  Shaking shaking(static_cast<std::size_t>(steps));
  for (int i = 0; i < steps; ++i) {
    auto& q = shaking[static_cast<std::size_t>(i)];
    const double t = (i + 1) * kTimeStep;
    const double entry = std::min(t, 1.0);
    q.time = t;
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
      q.displacement[axis] = demand.amplitude * entry * waves[axis].at(t);
      q.velocity[axis] = demand.amplitude * entry * waves[axis].rate_at(t);
    }
    // Vertical motion has higher frequencies.
    load(q, demand, 1 + kLoadVariation * vertical.at(5 * t));
  }
  return shaking;
}

Shaking adversity(const Demand& demand, int steps) {
  std::mt19937_64 engine{4};
  const auto uniform = [&] { return static_cast<double>(engine() >> 11U) * 0x1p-52 - 1; };
  Shaking shaking(static_cast<std::size_t>(steps));
  sim::Horizontal<double> before{};
  for (int i = 0; i < steps; ++i) {
    auto& q = shaking[static_cast<std::size_t>(i)];
    q.time = (i + 1) * kTimeStep;
    const double size = demand.amplitude * std::pow(10.0, 3 * uniform());
    const bool rests = i % 17 == 0, lifts = i % 5 == 0;
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
      q.displacement[axis] = rests ? before[axis] : size * uniform();
      q.velocity[axis] = (q.displacement[axis] - before[axis]) / kTimeStep;
    }
    load(q, demand, lifts ? -0.5 : 1 + 2 * std::abs(uniform()));
    before = q.displacement;
  }
  return shaking;
}

}  // namespace rths::bench
