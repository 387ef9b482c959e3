// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/machine/friction.hpp>

#include <cmath>

namespace rths::sim::machine {
namespace {

constexpr double kLargestExponent = 746;  // exp(−746) < 2⁻¹⁰⁷⁵ rounds to 0

}  // namespace

double LuGre::advance(double& z, double velocity, double coulomb, double time_step) const noexcept {
  const double stiffness = coulomb / presliding;
  const double ratio = velocity / stribeck_velocity;
  const double square = ratio * ratio;
  // Beyond, exp is 0; the library would report the underflow, which is slow.
  const double decay = square < kLargestExponent ? std::exp(-square) : 0;
  const double level = 1 + (stribeck_ratio - 1) * decay;  // g/F_c
  const double limit = std::copysign(presliding * level, velocity);
  const double rate = std::abs(velocity) / (presliding * level);
  // The equation is linear in z while v is constant. Stiff: up to 2e5 1/s.
  z = limit + (z - limit) * std::exp(-rate * time_step);
  return stiffness * (z + micro_damping * (velocity - rate * z));
}

}  // namespace rths::sim::machine
