// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "kinds.hpp"
#include "plane.hpp"
#include "presliding.hpp"

namespace rths::sim {
namespace {

struct CoulombFriction : Acts<Stage::Machine, kDissipative | kPerAxis> {
  static constexpr Text kName = "coulomb_friction";
  static constexpr Text kTitle = "Coulomb friction with presliding";
  static constexpr Text kEquation = "F = F_c s,  ds = (du - s |du|) / z_s";
  static constexpr Text kSource = kDahl;
  enum { kForce, kPresliding };
  static constexpr Parameter kParameters[] = {{"friction_force", "N", 0, 1e9, 0, 1e4},
                                              kPreslidingLength};
  static constexpr std::size_t kStates = kDahlStates;

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return term.parameters[kForce] * presliding(term, q, axis, term.parameters[kPresliding]);
  }
};

struct AsymmetricFriction : Acts<Stage::Machine, kDissipative | kPerAxis> {
  static constexpr Text kName = "asymmetric_friction";
  static constexpr Text kTitle = "Coulomb friction that differs forwards and backwards";
  static constexpr Text kEquation =
      "F = F_+ s for s > 0, F_- s for s < 0,  ds = (du - s |du|) / z_s";
  static constexpr Text kSource = kDahl;
  enum { kForward, kBackward, kPresliding };
  static constexpr Parameter kParameters[] = {{"forward_force", "N", 0, 1e9, 0, 1.2e4},
                                              {"backward_force", "N", 0, 1e9, 0, 0.8e4},
                                              kPreslidingLength};
  static constexpr std::size_t kStates = kDahlStates;

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto& s = presliding(term, q, axis, term.parameters[kPresliding]);
    return term.parameters[s > 0 ? kForward : kBackward] * s;
  }
};

// Not dissipative: presliding built up under low load returns more work.
struct LoadDependentFriction : Acts<Stage::Machine, kPerAxis> {
  static constexpr Text kName = "load_dependent_friction";
  static constexpr Text kTitle = "friction proportional to the vertical force";
  static constexpr Text kEquation = "F = mu max(N, 0) s,  ds = (du - s |du|) / z_s";
  static constexpr Text kSource = kDahl;
  enum { kCoefficient, kPresliding };
  static constexpr Parameter kParameters[] = {{"friction_coefficient", "-", 0, 1, 0, 2e-3},
                                              kPreslidingLength};
  static constexpr std::size_t kStates = kDahlStates;

  template <class Real>
  static Real force(const TermView<Real>& term, const Quantities<Real>& q, std::size_t axis) {
    const Real load = q.axial_load > 0 ? q.axial_load : Real{0};
    return term.parameters[kCoefficient] * load *
           presliding(term, q, axis, term.parameters[kPresliding]);
  }
};

// Not dissipative: presliding may return work of the breakaway.
struct StribeckFriction : Acts<Stage::Machine, kPerAxis> {
  static constexpr Text kName = "stribeck_friction";
  static constexpr Text kTitle = "Coulomb friction with breakaway";
  static constexpr Text kEquation = "F = (F_c + dF_s exp(-(v/v_s)^2)) s,  ds = (du - s |du|) / z_s";
  static constexpr Text kSource = "Armstrong-Helouvry, Dupont & Canudas de Wit 1994";
  enum { kForce, kBreakaway, kVelocity, kPresliding };
  static constexpr Parameter kParameters[] = {{"friction_force", "N", 0, 1e9, 0, 1e4},
                                              {"breakaway_force", "N", 0, 1e9, 0, 1e4},
                                              {"stribeck_velocity", "m/s", 1e-8, 10, 0.02, 0.05},
                                              kPreslidingLength};
  static constexpr std::size_t kStates = kDahlStates;

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto ratio = q.velocity[axis] / term.parameters[kVelocity];
    const auto level =
        term.parameters[kForce] + term.parameters[kBreakaway] * exp(-(ratio * ratio));
    return level * presliding(term, q, axis, term.parameters[kPresliding]);
  }
};

// Not dissipative: s builds up and is released at different displacements.
struct PositionDependentFriction : Acts<Stage::Machine, kPerAxis> {
  static constexpr Text kName = "position_dependent_friction";
  static constexpr Text kTitle = "local friction (rub)";
  static constexpr Text kEquation = "F = F_r exp(-((u - u_r)/w)^2) s,  ds = (du - s |du|) / z_s";
  static constexpr Text kSource = "Dahl 1968, exponent 1; the bell is ours";
  enum { kForce, kPlace, kWidth, kPresliding };
  static constexpr Parameter kParameters[] = {{"friction_force", "N", 0, 1e9, 0, 2e4},
                                              {"place", "m", -10, 10, 0, 0.05},
                                              {"width", "m", 1e-7, 10, 0.02, 0.02},
                                              kPreslidingLength};
  static constexpr std::size_t kStates = kDahlStates;

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto off = (q.displacement[axis] - term.parameters[kPlace]) / term.parameters[kWidth];
    return term.parameters[kForce] * exp(-(off * off)) *
           presliding(term, q, axis, term.parameters[kPresliding]);
  }
};

// Not dissipative: s builds up and is released at different velocities.
struct VelocityDependentFriction : Acts<Stage::Machine, kPerAxis> {
  static constexpr Text kName = "velocity_dependent_friction";
  static constexpr Text kTitle = "friction that grows smoothly with velocity";
  static constexpr Text kEquation = "F = F_v s |v|/(|v| + v_g),  ds = (du - s |du|) / z_s";
  static constexpr Text kSource = "Dahl 1968, exponent 1; the growth is ours";
  enum { kForce, kVelocity, kPresliding };
  static constexpr Parameter kParameters[] = {{"friction_force", "N", 0, 1e9, 0, 1e4},
                                              {"growth_velocity", "m/s", 1e-8, 100, 0.05, 0.05},
                                              kPreslidingLength};
  static constexpr std::size_t kStates = kDahlStates;

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto speed = abs(q.velocity[axis]);
    return term.parameters[kForce] * presliding(term, q, axis, term.parameters[kPresliding]) *
           (speed / (speed + term.parameters[kVelocity]));
  }
};

// Its store z_s F_c |s|^2/2 grows by F.du - F_c |s|^2 |du|.
struct PlanarFriction : Acts<Stage::Machine, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "planar_friction";
  static constexpr Text kTitle = "Coulomb friction in the plane with presliding";
  static constexpr Text kEquation = "F = F_c s,  ds = (du - s |du|) / z_s  (vectors)";
  static constexpr Text kSource = "Dahl 1968, exponent 1, for two directions";
  enum { kForce, kPresliding };
  static constexpr Parameter kParameters[] = {{"friction_force", "N", 0, 1e9, 0, 1e4},
                                              kPreslidingLength};
  static constexpr std::size_t kStates = 4;  // displacement before, s

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Plane<Real> u = displacement_of(q);
    const Plane<Real> du = u - Plane<Real>{term.state[0], term.state[1]};
    term.state[0] = u.x, term.state[1] = u.y;
    Plane<Real> s{term.state[2], term.state[3]};
    // Exact along a straight step.
    if (const Real path = length(du); path > 0) {
      const Real kept = exp(-path / term.parameters[kPresliding]);
      s = s * kept + du * Real{(1 - kept) / path};
    }
    term.state[2] = s.x, term.state[3] = s.y;
    q.force[0] += term.parameters[kForce] * s.x;
    q.force[1] += term.parameters[kForce] * s.y;
  }
};

struct ViscousFriction : Acts<Stage::Machine, kDissipative | kFrameIndifferent | kPerAxis> {
  static constexpr Text kName = "viscous_friction";
  static constexpr Text kTitle = "viscous friction";
  static constexpr Text kEquation = "F = c v";
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

std::span<const TermKind> friction_kinds() {
  return kinds_of<CoulombFriction, PlanarFriction, AsymmetricFriction, LoadDependentFriction,
                  StribeckFriction, VelocityDependentFriction, PositionDependentFriction,
                  ViscousFriction, AsymmetricViscous, QuadraticDrag, PowerDamping, PlatenInertia,
                  Cogging>();
}

}  // namespace rths::sim
