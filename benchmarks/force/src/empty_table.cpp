// SPDX-License-Identifier: Apache-2.0
#include "empty_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rths::bench {
namespace {

constexpr double kPeriod = 1e-3;  // of the samples [s]
constexpr int kSubsteps = 10;     // of the friction's integration
constexpr double kGravity = 9.80665;
constexpr double kPeak = 1.8 * kGravity;  // [m/s²]
constexpr double kForceNoise = 5e3;       // [N]
constexpr double kAccelerationNoise = 5e-3 * kGravity;
constexpr double kDisplacementNoise = 5e-5;  // [m]

struct Sine {
  double amplitude, omega, phase;  // of the acceleration [m/s²], [rad/s], [rad]
};

struct Motion {
  double x = 0, v = 0, a = 0;
};

// Sums of sines, scaled to the peak acceleration over the duration.
class Sines {
 public:
  Sines(std::vector<Sine> sines, double duration) : sines_{std::move(sines)} {
    double peak = 0;
    for (double t = 0; t < duration; t += kPeriod) peak = std::max(peak, std::abs(at(t).a));
    for (auto& sine : sines_) sine.amplitude *= kPeak / peak;
  }
  // The acceleration behind a Butterworth low-pass of second order, after its start has died away.
  [[nodiscard]] double filtered_acceleration(double t, double cutoff) const {
    double sum = 0;
    for (const auto& [amplitude, omega, phase] : sines_) {
      const double r = omega / cutoff;
      sum += amplitude *
             std::sin(omega * t + phase - std::atan2(std::numbers::sqrt2 * r, 1 - r * r)) /
             std::sqrt(1 + r * r * r * r);
    }
    return sum;
  }
  [[nodiscard]] Motion at(double t) const {
    Motion motion;
    for (const auto& [amplitude, omega, phase] : sines_) {
      const double angle = omega * t + phase;
      motion.x -= amplitude / (omega * omega) * std::sin(angle);
      motion.v -= amplitude / omega * std::cos(angle);
      motion.a += amplitude * std::sin(angle);
    }
    return motion;
  }

 private:
  std::vector<Sine> sines_;
};

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>{low, high}(random);
}

std::vector<Sine> harmonic(std::mt19937_64& random) {
  std::vector<Sine> sines;
  constexpr double kTwoPi = 2 * std::numbers::pi;
  for (const auto& [amplitude, frequency] :
       {std::pair{0.3, 0.2}, {1.0, 0.5}, {6.0, 1.3}, {9.0, 2.9}})
    sines.push_back({amplitude, kTwoPi * frequency, uniform(random, 0, kTwoPi)});
  return sines;
}

// Forty frequencies from 0.2 to 8 Hz with random phases; equal acceleration from 1.5 Hz on.
std::vector<Sine> earthquake(std::mt19937_64& random) {
  std::vector<Sine> sines;
  constexpr double kTwoPi = 2 * std::numbers::pi;
  constexpr int kCount = 40;
  for (int i = 0; i < kCount; ++i) {
    const double frequency = 0.2 * std::pow(40.0, (i + uniform(random, 0, 1)) / kCount);
    sines.push_back({std::min(1.0, std::pow(frequency / 1.5, 1.5)), kTwoPi * frequency,
                     uniform(random, 0, kTwoPi)});
  }
  return sines;
}

}  // namespace

controller::TableForce EmptyTable::truth() const {
  const double omega = 2 * std::numbers::pi * accelerometer_frequency;
  return {mass,
          coulomb,
          load_friction,
          viscous,
          offset,
          presliding,
          accelerometer_transport + std::numbers::sqrt2 / omega};
}

EmptyTable draw_machine(std::mt19937_64& random) {
  return {uniform(random, 100e3, 125e3), uniform(random, 3e3, 12e3), uniform(random, 1e-3, 3e-3),
          uniform(random, 300, 1300),    uniform(random, -3e3, 3e3), uniform(random, 0.3e-3, 3e-3),
          uniform(random, 100, 200),     uniform(random, 0, 3e-3)};
}

TableRun drive(const EmptyTable& machine, TableMotion kind, double load, double duration,
               std::mt19937_64& random) {
  const Sines sines{kind == TableMotion::Harmonic ? harmonic(random) : earthquake(random),
                    duration};
  const double load_phase = uniform(random, 0, 6);
  std::normal_distribution<double> normal{0, 1};
  const double cutoff = 2 * std::numbers::pi * machine.accelerometer_frequency;
  constexpr double kStep = kPeriod / kSubsteps;
  double z = 0;
  TableRun run;
  const long samples = std::lround(duration / kPeriod);
  for (long i = 0; i < samples; ++i) {
    for (int k = 0; k < kSubsteps; ++k) {
      const double v = sines.at(static_cast<double>(i) * kPeriod + (k + 0.5) * kStep).v;
      const double level = v < 0 ? -1 : 1;
      z = level + (z - level) * std::exp(-std::abs(v) * kStep / machine.presliding);
    }
    const double t = static_cast<double>(i + 1) * kPeriod;
    const Motion motion = sines.at(t);
    const double axial = load * (1 + 0.3 * std::sin(2 * std::numbers::pi * 0.37 * t + load_phase));
    const double force = machine.mass * motion.a +
                         (machine.coulomb + machine.load_friction * axial) * z +
                         machine.viscous * motion.v + machine.offset;
    run.largest_acceleration = std::max(run.largest_acceleration, std::abs(motion.a));
    run.displacement.push_back(motion.x + kDisplacementNoise * normal(random));
    run.acceleration.push_back(
        sines.filtered_acceleration(t - machine.accelerometer_transport, cutoff) +
        kAccelerationNoise * normal(random));
    run.force.push_back(force + kForceNoise * normal(random));
    run.axial_load.push_back(axial);
  }
  return run;
}

}  // namespace rths::bench
