// SPDX-License-Identifier: Apache-2.0
#include "motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "actuator.hpp"

namespace trial {
namespace {

constexpr std::size_t kStride = 2;
static_assert(kModelStep == kStride * kSampleTime);
constexpr double kMotionBand = 90;      ///< [Hz]
constexpr double kLowestCrossover = 2;  ///< of displacement and acceleration [Hz]

double crossover(const ChannelNoise& noise) {
  const double ratio = noise.acceleration.deviation / noise.displacement.deviation;
  return std::max(kLowestCrossover, std::sqrt(ratio) / (2 * std::numbers::pi));
}

double smooth(double frequency) { return 1 / (1 + std::pow(frequency / kMotionBand, 8)); }

// One axis of a motion from its displacement and acceleration channels.
//     U = U_m (1 - H) - A H / (2 π f)²,  H = f⁴ / (f⁴ + f_c⁴)
void fuse(const Signal& displacement, const Signal& acceleration, double corner, std::size_t axis,
          Motion& motion) {
  const Spectrum U = spectrum_of(displacement), A = spectrum_of(acceleration);
  const double corner4 = std::pow(corner, 4);
  Spectrum fused(U.size());
  for (std::size_t k = 0; k < U.size(); ++k) {
    const std::size_t folded = std::min(k, U.size() - k);
    const double f = static_cast<double>(folded) / (static_cast<double>(U.size()) * kSampleTime);
    const double square = f * f, bottom = square * square + corner4;
    fused[k] = U[k] * (corner4 / bottom) -
               A[k] * (square / bottom / (4 * std::numbers::pi * std::numbers::pi));
  }
  const std::size_t n = displacement.size();
  const Signal u = filtered(fused, kSampleTime, n, smooth);
  const Signal v = filtered(fused, kSampleTime, n, [](double f) {
    return std::complex<double>{0, 2 * std::numbers::pi * f * smooth(f)};
  });
  const Signal a = filtered(A, kSampleTime, n, smooth);
  for (std::size_t k = 0; k < motion.size(); ++k) {
    motion[k].displacement[axis] = u[k * kStride];
    motion[k].velocity[axis] = v[k * kStride];
    motion[k].acceleration[axis] = a[k * kStride];
  }
}

Motion still() {
  Motion motion(kSamples / kStride);
  for (std::size_t k = 0; k < motion.size(); ++k)
    motion[k].time = static_cast<double>(k) * kModelStep;
  return motion;
}

void remove_rest(Signal& signal) {
  const auto quiet = static_cast<std::size_t>(0.95 * kQuietTime / kSampleTime);
  double rest = 0;
  for (std::size_t k = 0; k < quiet; ++k) rest += signal[k] / static_cast<double>(quiet);
  for (double& value : signal) value -= rest;
}

}  // namespace

Motion true_motion(const Record& record) {
  Motion motion;
  for (std::size_t k = 0; k < record.truth.size(); k += kStride) motion.push_back(record.truth[k]);
  return motion;
}

Motion measured_motion(const Record& record, const Physics& wrong, const ChannelNoise& noise) {
  Motion motion = still();
  const Physics right = absent();
  std::vector<Plane> corrected = record.acceleration;
  for (std::size_t k = 0; k < corrected.size(); ++k) {
    const Plane with = accelerometer(wrong, record.truth[k]);
    const Plane without = accelerometer(right, record.truth[k]);
    for (std::size_t i = 0; i < 2; ++i) corrected[k][i] -= with[i] - without[i];
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    Signal u = axis_of(record.displacement, axis), a = axis_of(corrected, axis);
    remove_rest(u);
    remove_rest(a);
    fuse(u, a, crossover(noise), axis, motion);
  }
  for (std::size_t k = 0; k < motion.size(); ++k)
    motion[k].axial_load = record.axial_load[k * kStride];
  return motion;
}

Motion motion_error(const ChannelNoise& noise, Random& random) {
  Motion error = still();
  for (std::size_t axis = 0; axis < 2; ++axis) {
    Noise of_displacement{noise.displacement, kSampleTime, random};
    Noise of_acceleration{noise.acceleration, kSampleTime, random};
    Signal u, a;
    for (std::size_t k = 0; k < kSamples; ++k) {
      u.push_back(of_displacement.next(random));
      a.push_back(of_acceleration.next(random));
    }
    remove_rest(u);
    remove_rest(a);
    fuse(u, a, crossover(noise), axis, error);
  }
  return error;
}

Motion sum(const Motion& motion, const Motion& error) {
  Motion both = motion;
  for (std::size_t k = 0; k < both.size(); ++k)
    for (std::size_t i = 0; i < 2; ++i) {
      both[k].displacement[i] += error[k].displacement[i];
      both[k].velocity[i] += error[k].velocity[i];
      both[k].acceleration[i] += error[k].acceleration[i];
    }
  return both;
}

std::vector<Plane> force_at(const Physics& physics, const Motion& motion) {
  Bearing bearing{physics, kModelStep};
  Platen platen{physics};
  LoadCell load_cell{physics, kModelStep};
  std::vector<Plane> force;
  force.reserve(motion.size());
  for (const Boundary& now : motion) {
    const Plane restoring = bearing.advance(now), machine = platen.advance(now);
    load_cell.advance({restoring[0] + machine[0], restoring[1] + machine[1]}, now);
    force.push_back(load_cell.recorded());
  }
  return force;
}

std::vector<Plane> displacement_at(const Physics& physics, const Record& record) {
  Actuator actuator{physics, kSampleTime};
  std::vector<Plane> displacement;
  displacement.reserve(record.command.size());
  for (std::size_t k = 0; k < record.command.size(); ++k) {
    displacement.push_back(actuator.platen().displacement);
    actuator.advance(record.command[k], record.load[k]);
  }
  return displacement;
}

}  // namespace trial
