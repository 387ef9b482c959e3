// SPDX-License-Identifier: Apache-2.0
#include "structure.hpp"

#include <numbers>

namespace trial {
namespace {

constexpr double kTotalMass = kReferenceLoad / kStandardGravity;  ///< on one bearing [kg]
constexpr double kBaseMass = 0.3 * kTotalMass;
constexpr double kTopMass = kTotalMass - kBaseMass;
constexpr double kTopFrequency = 2 * std::numbers::pi * 3.5;  ///< on a fixed base [rad/s]
constexpr double kTopStiffness = kTopMass * kTopFrequency * kTopFrequency;  ///< [N/m]
constexpr double kTopDamping = 2 * 0.03 * kTopMass * kTopFrequency;         ///< [N*s/m]
constexpr double kBaseDamping = 2e5;                                        ///< [N*s/m]

struct Storey {
  double base, base_rate, top, top_rate;
};

// Velocities and accelerations.
Storey rate(const Storey& s, double force, double ground) {
  const double storey = kTopStiffness * (s.top - s.base) + kTopDamping * (s.top_rate - s.base_rate);
  return {s.base_rate, (storey - force - kBaseDamping * s.base_rate) / kBaseMass - ground,
          s.top_rate, -storey / kTopMass - ground};
}

Storey plus(const Storey& s, const Storey& rate, double step) {
  return {s.base + step * rate.base, s.base_rate + step * rate.base_rate, s.top + step * rate.top,
          s.top_rate + step * rate.top_rate};
}

}  // namespace

void Structure::advance(const Plane& force, const Plane& ground, double step) {
  for (std::size_t i = 0; i < 2; ++i) {
    const Storey now{base_displacement_[i], base_velocity_[i], top_displacement_[i],
                     top_velocity_[i]};
    const Storey first = rate(now, force[i], ground[i]);
    const Storey second = rate(plus(now, first, step), force[i], ground[i]);
    const Storey next = plus(plus(now, first, 0.5 * step), second, 0.5 * step);
    base_displacement_[i] = next.base;
    base_velocity_[i] = next.base_rate;
    top_displacement_[i] = next.top;
    top_velocity_[i] = next.top_rate;
    base_acceleration_[i] = rate(next, force[i], ground[i]).base_rate;
  }
}

Plane compensated(const Structure& structure) {
  constexpr double kDelay = kTransportDelay;
  constexpr double kFrequency = 2 * std::numbers::pi * kActuatorFrequency;
  constexpr double kVelocity = kDelay + 2 * kActuatorDamping / kFrequency;
  constexpr double kAcceleration = 0.5 * kDelay * kDelay +
                                   2 * kActuatorDamping / kFrequency * kDelay +
                                   1 / (kFrequency * kFrequency);
  Plane command{};
  for (std::size_t i = 0; i < 2; ++i)
    command[i] = structure.displacement()[i] + kVelocity * structure.velocity()[i] +
                 kAcceleration * structure.acceleration()[i];
  return command;
}

}  // namespace trial
