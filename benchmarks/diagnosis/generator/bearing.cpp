// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "specimen.hpp"

namespace trial {
namespace {

constexpr std::array<double, 4> kShapeLengths{1.2e-3, 4e-3, 13e-3, 45e-3};  ///< [m]
constexpr double kContactStiffness = 2e10;  ///< of a seat that has closed [N/m]

// dz for an increment of the displacement (see the header).
Plane loop_rate(const Physics& p, double yield, const Plane& z, const Plane& du) {
  const double coupling = p[kCoupling];
  Plane rate{};
  double sharp = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t j = 1 - i;
    const double square = z[i] * z[i] + coupling * z[j] * z[j];
    const double work = z[i] * du[i] + coupling * z[j] * du[j];
    // With full coupling both axes have the same value.
    if (i == 0 || coupling != 1) sharp = square > 0 ? std::pow(square, 0.5 * p[kExponent] - 1) : 0;
    const double sign = work > 0 ? 1 : -1;
    rate[i] = (du[i] - z[i] * sharp * work * (1 - p[kBeta] + p[kBeta] * sign)) / yield;
  }
  return rate;
}

void heun(const Physics& p, double yield, Plane& z, const Plane& du) {
  const Plane first = loop_rate(p, yield, z, du);
  const Plane second = loop_rate(p, yield, {z[0] + first[0], z[1] + first[1]}, du);
  for (std::size_t i = 0; i < 2; ++i) z[i] += 0.5 * (first[i] + second[i]);
}

// Play: the bearing moves only if an edge of the gap pushes it.
double pushed(double before, double platen, double gap) {
  return std::clamp(before, platen - 0.5 * gap, platen + 0.5 * gap);
}

}  // namespace

Bearing::Bearing(const Physics& physics, double step) : physics_(physics), step_(step) {}

// With an open gap the bearing rests at zero force; a closed gap is a stiff contact.
Plane Bearing::with_slack(const Plane& platen) const {
  const double tangent = physics_[kStiffness] + physics_[kStrength] / physics_[kYieldDisplacement];
  const double half = 0.5 * physics_[kSlack];
  Plane bearing{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double free = displacement_[i] - force_[i] / tangent;
    const double side = platen[i] > free ? half : -half;
    const double closed =
        (kContactStiffness * (platen[i] - side) + tangent * free) / (kContactStiffness + tangent);
    bearing[i] = std::abs(platen[i] - free) <= half ? free : closed;
  }
  return bearing;
}

Plane Bearing::mounted(const Plane& platen) const {
  if (physics_[kSlack] > 0) return with_slack(platen);
  Plane moved = platen;
  for (std::size_t i = 0; i < 2; ++i) {
    moved[i] -= physics_[kFlexibility] * force_[i];
    if (physics_[kBacklash] > 0) moved[i] = pushed(displacement_[i], moved[i], physics_[kBacklash]);
  }
  return moved;
}

void Bearing::advance_loops(const Plane& increment) {
  const Plane before = loop_;
  const double share = physics_[kMixShare];
  const double yield = physics_[kYieldDisplacement];
  heun(physics_, yield, loop_, increment);
  if (share > 0) heun(physics_, yield * physics_[kMixRatio], second_loop_, increment);
  remember(increment, {loop_[0] - before[0], loop_[1] - before[1]});
}

// State variables of single effects.
void Bearing::remember(const Plane& increment, const Plane& turned) {
  const double yield = physics_[kYieldDisplacement];
  const double length = std::hypot(increment[0], increment[1]);
  double plastic = 0;
  for (std::size_t i = 0; i < 2; ++i) plastic += loop_[i] * (increment[i] - yield * turned[i]);
  if (physics_[kHeating] > 0)
    plastic_path_ += std::abs(plastic) * std::exp(-physics_[kHeating] * plastic_path_) -
                     step_ * physics_[kCooling] * plastic_path_;
  if (physics_[kMaxwell] > 0) {
    const double decay = std::exp(-step_ * physics_[kMaxwellRate]);
    for (std::size_t i = 0; i < 2; ++i)
      branch_[i] = decay * branch_[i] + physics_[kMaxwell] * std::sqrt(decay) * increment[i];
  }
  for (std::size_t k = 0; k < shape_.size(); ++k) {
    if (physics_[kShape1 + k] == 0) continue;
    const double path = length / kShapeLengths[k];
    for (std::size_t i = 0; i < 2; ++i) {
      const double ahead = length > 0 ? increment[i] / length : 0;
      shape_[k][i] += (ahead - shape_[k][i]) * path / (1 + 0.5 * path);  // trapezoidal
    }
  }
}

double Bearing::strength(const Boundary& platen, double speed) const {
  const Physics& p = physics_;
  double factor = p[kHeating] > 0 ? std::exp(-p[kHeating] * plastic_path_) : 1;
  factor *= 1 + p[kAxialStrength] * (platen.axial_load / kReferenceLoad - 1);
  if (p[kRate] > 0) factor *= 1 + p[kRate] * std::log1p(speed / p[kRateVelocity]);
  if (platen.time >= p[kDamageTime]) factor *= 1 - p[kDamage];
  return p[kStrength] * factor;
}

double Bearing::stiffness(double load_ratio) const {
  const Physics& p = physics_;
  double factor = 1 - p[kAxialStiffness] * (load_ratio * load_ratio - 1);
  if (p[kScragging] > 0) factor *= 1 + p[kScragging] * std::exp(-largest_ / p[kScraggingLength]);
  return p[kStiffness] * factor;
}

Plane Bearing::advance(const Boundary& platen) {
  const Physics& p = physics_;
  const Plane moved = mounted(platen.displacement);
  const Plane increment{moved[0] - displacement_[0], moved[1] - displacement_[1]};
  advance_loops(increment);
  displacement_ = moved;
  const double radius = std::hypot(moved[0], moved[1]);
  largest_ = std::max(largest_, radius);

  const double plug = strength(platen, std::hypot(increment[0], increment[1]) / step_);
  double elastic = stiffness(platen.axial_load / kReferenceLoad) + p[kCubic] * radius * radius;
  if (radius > p[kStiffeningOnset]) elastic += p[kStiffening] * (1 - p[kStiffeningOnset] / radius);
  const Plane quadratic{p[kQuadraticX], p[kQuadraticY]};
  for (std::size_t i = 0; i < 2; ++i) {
    const double mixed = (1 - p[kMixShare]) * loop_[i] + p[kMixShare] * second_loop_[i];
    force_[i] = elastic * moved[i] + plug * mixed + branch_[i] + quadratic[i] * moved[i] * moved[i];
    for (std::size_t k = 0; k < shape_.size(); ++k) force_[i] += p[kShape1 + k] * shape_[k][i];
  }
  return force_;
}

}  // namespace trial
