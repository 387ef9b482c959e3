// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/machine/platen_machine.hpp>

#include <numbers>
#include <random>

#include <fmt/format.h>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::sim::machine {

double PlatenMachine::weight() const { return mass[2] * kStandardGravity; }

Vector6 natural_frequencies(const PlatenMachine& m) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(6, 6);
  const auto spring = [&](double stiffness, const Vector6& along) {
    K += stiffness * along * along.transpose();
  };
  for (std::size_t i = 0; i < kHorizontal; ++i)
    spring(oil_stiffness(m.actuator(i), m.supply, 0),
           actuator_length(m.base[i], m.swivel[i], Eigen::Vector3d::Zero()).jacobian);
  for (const auto& foot : m.foot)
    spring(
        oil_stiffness(m.vertical, m.supply, 0),
        pad_height(foot, m.depth, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()).jacobian);
  for (const auto& arm : m.outriggers.arm) {
    Vector6 up;
    up << 0, 0, 1, arm[1], -arm[0], 0;
    spring(2 * m.outriggers.stiffness, up);
  }
  // K φ = ω² M φ with ψ = √M φ, since M is diagonal.
  Vector6 root;
  root << m.mass.cwiseSqrt().cwiseInverse(), m.inertia.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = root.asDiagonal() * K * root.asDiagonal();
  const Eigen::VectorXd squares = maths::symmetric_modes(scaled).values;
  return squares.cwiseMax(0).cwiseSqrt() / (2 * std::numbers::pi);
}

Bearing with_stiffness(Bearing bearing, double factor) {
  for (auto& term : bearing.terms) {
    for (auto& [name, value] : term.parameters) {
      if (name == "post_yield_stiffness" || name == "stiffness") value *= factor;
      if (name == "yield_displacement") value /= factor;
    }
  }
  return bearing;
}

FamilyMember family_member(const PlatenMachine& nominal, int index) {
  if (index < 0 || index > kFamilySize)
    throw Error{
        fmt::format("machine: member {} of the family, expected 0 to {}", index, kFamilySize)};
  FamilyMember member{nominal};
  if (index == 0) return member;
  std::mt19937_64 engine{static_cast<std::uint64_t>(index)};
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11U) * 0x1p-53;
  };
  PlatenMachine& m = member.machine;
  m.supply.bulk_modulus *= draw(0.8, 1.2);
  const double frequency = draw(0.85, 1.15);
  const double dead_band = draw(0.005, 0.02);
  for (Actuator* a : {&m.along_long, &m.along_lat}) {
    a->valve_frequency *= frequency;
    a->dead_band = dead_band;
  }
  const double friction = draw(0.5, 1.5);
  m.friction.coulomb *= friction;
  m.friction.viscous *= friction;
  m.friction.coefficient *= friction;
  member.specimen_stiffness = draw(0.7, 1.3);
  m.vertical_specimen.stiffness *= member.specimen_stiffness;
  m.seed = static_cast<std::uint64_t>(index);
  return member;
}

}  // namespace rths::sim::machine
