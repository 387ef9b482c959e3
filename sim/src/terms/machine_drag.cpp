// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "kinds.hpp"

namespace rths::sim {
namespace {

struct ViscousFriction : Acts<Stage::Machine, kDissipative | kFrameIndifferent | kPerAxis> {
  static constexpr Text kName = "viscous_friction";
  static constexpr Text kTitle = "viscous friction";
  static constexpr Text kEquation = "F = c v";
  static constexpr Text kSource = "textbook";
  enum { kCoefficient };
  static constexpr Parameter kParameters[] = {{"coefficient", "N*s/m", 0, 1e13, 0, 2e4}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return term.parameters[kCoefficient] * q.velocity[axis];
  }
};

struct AsymmetricViscous : Acts<Stage::Machine, kDissipative | kPerAxis> {
  static constexpr Text kName = "asymmetric_viscous";
  static constexpr Text kTitle = "viscous friction that differs forwards and backwards";
  static constexpr Text kEquation = "F = c_+ v for v > 0, c_- v for v < 0";
  static constexpr Text kSource = "textbook";
  enum { kForward, kBackward };
  static constexpr Parameter kParameters[] = {{"forward_coefficient", "N*s/m", 0, 1e13, 0, 3e4},
                                              {"backward_coefficient", "N*s/m", 0, 1e13, 0, 1e4}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto& v = q.velocity[axis];
    return term.parameters[v > 0 ? kForward : kBackward] * v;
  }
};

struct QuadraticDrag : Acts<Stage::Machine, kDissipative | kPerAxis> {
  static constexpr Text kName = "quadratic_drag";
  static constexpr Text kTitle = "quadratic drag (pipes, orifices)";
  static constexpr Text kEquation = "F = c_2 |v| v";
  static constexpr Text kSource = "textbook; of a pipe c_2 = rho zeta A^3 / (2 a^2)";
  enum { kCoefficient };
  static constexpr Parameter kParameters[] = {{"coefficient", "N*s2/m2", 0, 1e18, 0, 2e4}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto& v = q.velocity[axis];
    return term.parameters[kCoefficient] * (abs(v) * v);
  }
};

// Seals and orifices: of an exponent below 1 the slope at rest is finite.
struct PowerDamping : Acts<Stage::Machine, kDissipative | kPerAxis> {
  static constexpr Text kName = "power_damping";
  static constexpr Text kTitle = "damping with a power of velocity";
  static constexpr Text kEquation = "F = F_r r (r^2 + e^2)^((a - 1)/2),  r = v/v_r,  e = 0.001";
  static constexpr Text kSource =
      "Seleemah & Constantinou 1997, F = C |v|^a sgn(v); rounded at rest by us";
  enum { kForce, kExponent, kVelocity };
  static constexpr double kRest = 1e-3;  // of the reference velocity
  static constexpr Parameter kParameters[] = {{"force", "N", 0, 1e9, 0, 2e4},
                                              {"exponent", "-", 0.05, 5, 1, 0.4},
                                              {"reference_velocity", "m/s", 1e-6, 100, 1, 1}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto half = 0.5 * (term.parameters[kExponent] - 1);
    const auto ratio = q.velocity[axis] / term.parameters[kVelocity];
    return term.parameters[kForce] * ratio * pow(ratio * ratio + kRest * kRest, half);
  }
};

struct PlatenInertia : Acts<Stage::Machine, kFrameIndifferent | kPerAxis | kInertial> {
  static constexpr Text kName = "platen_inertia";
  static constexpr Text kTitle = "inertia of parts moving with the platen";
  static constexpr Text kEquation = "F = m a";
  static constexpr Text kSource = "Newton";
  enum { kMass };
  // Negative: the inertia correction was too large.
  static constexpr Parameter kParameters[] = {{"mass", "kg", -1e12, 1e12, 0, 5e3}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return term.parameters[kMass] * q.acceleration[axis];
  }
};

struct Cogging : Acts<Stage::Machine, kPerAxis> {
  static constexpr Text kName = "cogging";
  static constexpr Text kTitle = "force periodic in displacement (cogging)";
  static constexpr Text kEquation = "F = F_g sin(2 pi u / p + phi)";
  static constexpr Text kSource = "textbook";
  enum { kForce, kPitch, kPhase };
  static constexpr Parameter kParameters[] = {{"force", "N", 0, 1e7, 0, 2e4},
                                              {"pitch", "m", 1e-4, 10, 0.05, 0.05},
                                              {"phase", "rad", -3.2, 3.2, 0, 0.5}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto wave_number = 2 * std::numbers::pi / term.parameters[kPitch];
    return term.parameters[kForce] *
           sin(wave_number * q.displacement[axis] + term.parameters[kPhase]);
  }
};

}  // namespace

std::span<const TermKind> drag_kinds() {
  return kinds_of<ViscousFriction, AsymmetricViscous, QuadraticDrag, PowerDamping, PlatenInertia,
                  Cogging>();
}

}  // namespace rths::sim
