// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "kinds.hpp"

namespace rths::sim {
namespace {

// Adds f(axis) to the force of each axis that the term acts on.
template <class Real, class Force>
void add(const TermView<Real>& term, Quantities<Real>& q, Force force) {
  for_each_active_axis(term, [&](std::size_t axis) { q.force[axis] += force(axis); });
}

struct ViscousFriction : Acts<Stage::Machine, kDissipative | kFrameIndifferent | kPerAxis> {
  static constexpr std::string_view kName = "viscous_friction";
  static constexpr std::string_view kTitle = "viscous friction";
  static constexpr std::string_view kEquation = "F = c v";
  static constexpr std::string_view kSource = "textbook";
  enum { kCoefficient };
  static constexpr Parameter kParameters[] = {{"coefficient", "N*s/m", 0, 1e13, 0, 2e4}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    add(term, q,
        [&](std::size_t axis) { return term.parameters[kCoefficient] * q.velocity[axis]; });
  }
};

struct AsymmetricViscous : Acts<Stage::Machine, kDissipative | kPerAxis> {
  static constexpr std::string_view kName = "asymmetric_viscous";
  static constexpr std::string_view kTitle = "viscous friction that differs forwards and backwards";
  static constexpr std::string_view kEquation = "F = c_+ v for v > 0, c_- v for v < 0";
  static constexpr std::string_view kSource = "textbook";
  enum { kForward, kBackward };
  static constexpr Parameter kParameters[] = {{"forward_coefficient", "N*s/m", 0, 1e13, 0, 3e4},
                                              {"backward_coefficient", "N*s/m", 0, 1e13, 0, 1e4}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    add(term, q, [&](std::size_t axis) {
      const Real& v = q.velocity[axis];
      return term.parameters[v > 0 ? kForward : kBackward] * v;
    });
  }
};

struct QuadraticDrag : Acts<Stage::Machine, kDissipative | kPerAxis> {
  static constexpr std::string_view kName = "quadratic_drag";
  static constexpr std::string_view kTitle = "quadratic drag (pipes, orifices)";
  static constexpr std::string_view kEquation = "F = c_2 |v| v";
  static constexpr std::string_view kSource = "textbook; of a pipe c_2 = rho zeta A^3 / (2 a^2)";
  enum { kCoefficient };
  static constexpr Parameter kParameters[] = {{"coefficient", "N*s2/m2", 0, 1e18, 0, 2e4}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    add(term, q, [&](std::size_t axis) {
      const Real& v = q.velocity[axis];
      return term.parameters[kCoefficient] * (abs(v) * v);
    });
  }
};

// Seals and orifices: of an exponent below 1 the slope at rest is finite.
struct PowerDamping : Acts<Stage::Machine, kDissipative | kPerAxis> {
  static constexpr std::string_view kName = "power_damping";
  static constexpr std::string_view kTitle = "damping with a power of velocity";
  static constexpr std::string_view kEquation =
      "F = F_r r (r^2 + e^2)^((a - 1)/2),  r = v/v_r,  e = 0.001";
  static constexpr std::string_view kSource =
      "Seleemah & Constantinou 1997, F = C |v|^a sgn(v); rounded at rest by us";
  enum { kForce, kExponent, kVelocity };
  static constexpr double kRest = 1e-3;  // of the reference velocity
  static constexpr Parameter kParameters[] = {{"force", "N", 0, 1e9, 0, 2e4},
                                              {"exponent", "-", 0.05, 5, 1, 0.4},
                                              {"reference_velocity", "m/s", 1e-6, 100, 1, 1}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real half = 0.5 * (term.parameters[kExponent] - 1);
    add(term, q, [&](std::size_t axis) {
      const Real ratio = q.velocity[axis] / term.parameters[kVelocity];
      return term.parameters[kForce] * ratio * pow(ratio * ratio + kRest * kRest, half);
    });
  }
};

struct PlatenInertia : Acts<Stage::Machine, kFrameIndifferent | kPerAxis | kInertial> {
  static constexpr std::string_view kName = "platen_inertia";
  static constexpr std::string_view kTitle = "inertia of parts moving with the platen";
  static constexpr std::string_view kEquation = "F = m a";
  static constexpr std::string_view kSource = "Newton";
  enum { kMass };
  // Negative: the inertia correction was too large.
  static constexpr Parameter kParameters[] = {{"mass", "kg", -1e12, 1e12, 0, 5e3}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    add(term, q, [&](std::size_t axis) { return term.parameters[kMass] * q.acceleration[axis]; });
  }
};

struct Cogging : Acts<Stage::Machine, kPerAxis> {
  static constexpr std::string_view kName = "cogging";
  static constexpr std::string_view kTitle = "force periodic in displacement (cogging)";
  static constexpr std::string_view kEquation = "F = F_g sin(2 pi u / p + phi)";
  static constexpr std::string_view kSource = "textbook";
  enum { kForce, kPitch, kPhase };
  static constexpr Parameter kParameters[] = {{"force", "N", 0, 1e7, 0, 2e4},
                                              {"pitch", "m", 1e-4, 10, 0.05, 0.05},
                                              {"phase", "rad", -3.2, 3.2, 0, 0.5}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real wave_number = 2 * std::numbers::pi / term.parameters[kPitch];
    add(term, q, [&](std::size_t axis) {
      return term.parameters[kForce] *
             sin(wave_number * q.displacement[axis] + term.parameters[kPhase]);
    });
  }
};

}  // namespace

std::span<const TermKind> drag_kinds() {
  return kinds_of<ViscousFriction, AsymmetricViscous, QuadraticDrag, PowerDamping, PlatenInertia,
                  Cogging>();
}

}  // namespace rths::sim
