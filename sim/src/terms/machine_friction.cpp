// SPDX-License-Identifier: Apache-2.0
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

}  // namespace

std::span<const TermKind> friction_kinds() {
  return kinds_of<CoulombFriction, PlanarFriction, AsymmetricFriction, LoadDependentFriction,
                  StribeckFriction, VelocityDependentFriction, PositionDependentFriction>();
}

}  // namespace rths::sim
