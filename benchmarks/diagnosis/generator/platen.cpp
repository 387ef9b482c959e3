// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "specimen.hpp"

namespace trial {
namespace {

// Dahl's law (1968) along a step, in substeps small enough for Heun's rule.
//     ds = (du - s |du|) / z_s
double dahl(double slip, double increment, double presliding) {
  constexpr double kSubstep = 0.25;  // of the presliding displacement
  constexpr double kMaxSubsteps = 40;
  if (increment == 0) return slip;
  const double substeps =
      std::clamp(std::ceil(std::abs(increment) / (kSubstep * presliding)), 1.0, kMaxSubsteps);
  const double du = std::min(std::abs(increment) / (substeps * presliding), 1.0);
  const double ahead = increment > 0 ? 1 : -1;
  for (int i = 0; i < static_cast<int>(substeps); ++i) {
    const double first = (ahead - slip) * du;
    slip += 0.5 * (first + (ahead - slip - first) * du);
  }
  return slip;
}

double bump(double distance) {
  const double cosine = std::abs(distance) < 1 ? std::cos(0.5 * std::numbers::pi * distance) : 0;
  return cosine * cosine;
}

}  // namespace

double Platen::friction(std::size_t axis, const Boundary& platen) const {
  const Physics& p = physics_;
  const double u = platen.displacement[axis], v = platen.velocity[axis];
  const double ahead = slip_[axis] > 0 ? 1 : -1;
  const double rub = (u - p[kRubPlace]) / p[kRubWidth];
  const double stribeck = v / p[kStribeckVelocity];
  double force = p[kFrictionX + axis] + ahead * p[kAsymmetryX + axis];
  force += p[kLoadFriction] * std::max(platen.axial_load, 0.0);
  if (p[kRub] > 0) force += p[kRub] * std::exp(-rub * rub);
  if (p[kBreakaway] > 0) force += p[kBreakaway] * std::exp(-stribeck * stribeck);
  if (p[kPatch] > 0) force += p[kPatch] * bump((u - p[kPatchPlace]) / p[kPatchWidth]);
  return (force + p[kWear] * path_[axis]) * slip_[axis];
}

// A stop beyond a corner: contact needs displacement along both axes at once.
double Platen::corner(std::size_t axis, const Boundary& platen) const {
  const Plane towards{physics_[kCornerSide] * platen.displacement[0], platen.displacement[1]};
  const double depth = std::min(towards[0], towards[1]) - physics_[kCornerPlace];
  const bool faces_it = towards[axis] <= towards[1 - axis];
  if (depth <= 0 || !faces_it) return 0;
  return physics_[kCorner] * depth * (axis == 0 ? physics_[kCornerSide] : 1);
}

double Platen::outside(std::size_t axis, const Boundary& platen) const {
  const Physics& p = physics_;
  const double u = platen.displacement[axis], v = platen.velocity[axis];
  const double other = platen.velocity[1 - axis];
  constexpr double kTurn = 2 * std::numbers::pi;
  double force = p[kOneSidedX + axis] * std::max(v, 0.0);
  if (p[kCogging] > 0)
    force += p[kCogging] * (std::sin(kTurn * u / p[kCoggingPitch] + p[kCoggingPhase]) -
                            std::sin(p[kCoggingPhase]));
  if (p[kRipple] > 0)
    force += p[kRipple] * std::sin(kTurn * p[kRippleFrequency] * platen.time + p[kRipplePhase] +
                                   static_cast<double>(axis));
  if (p[kRatchet] != 0)
    force += p[kRatchet] * std::tanh(v * other / (p[kRatchetVelocity] * p[kRatchetVelocity]));
  if (p[kCorner] > 0) force += corner(axis, platen);
  return force + p[kGyroscopic] * (axis == 0 ? other : -other);
}

Plane Platen::advance(const Boundary& platen) {
  const Physics& p = physics_;
  Plane force{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double u = platen.displacement[i], v = platen.velocity[i];
    slip_[i] = dahl(slip_[i], u - displacement_[i], p[kPresliding]);
    path_[i] += std::abs(u - displacement_[i]);
    displacement_[i] = u;
    force[i] = kPlatenMass[i] * (1 + p[kMassErrorX + i]) * platen.acceleration[i];
    force[i] += (p[kViscousX + i] + p[kDrag] * std::abs(v)) * v;
    force[i] += p[kPDelta] * platen.axial_load * u;
    force[i] += friction(i, platen) + outside(i, platen);
  }
  return force;
}

}  // namespace trial
