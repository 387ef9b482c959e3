// SPDX-License-Identifier: Apache-2.0
// Forces of the rubber besides its linear stiffness: docs/theory/lead_rubber.md, "Restoring".

#include "elastomeric.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

template <class Real>
void add(Quantities<Real>& q, const Plane<Real>& force) {
  q.force[0] += force.x;
  q.force[1] += force.y;
}

struct LargeStrainStiffening : Acts<Stage::Restoring, kFrameIndifferent> {
  static constexpr Text kName = "large_strain_stiffening";
  static constexpr Text kTitle = "stiffening at large strain";
  static constexpr Text kEquation = "F = k_h max(0, |u| - u_h) u/|u|";
  static constexpr Text kSource = "bilinear envelope of natural rubber";
  enum { kStiffness, kOnset };
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m", 0, 1e15, 0, 2e6},
                                              {"onset", "m", 0, 10, 0.1, 0.1}};

  static void step(const auto& term, auto& q) {
    const auto u = displacement_of(q);
    const auto radius = length(u);
    const auto& onset = term.parameters[kOnset];
    if (radius > onset) add(q, u * (term.parameters[kStiffness] * (1 - onset / radius)));
  }
};

struct CubicStiffness : Acts<Stage::Restoring, kFrameIndifferent> {
  static constexpr Text kName = "cubic_stiffness";
  static constexpr Text kTitle = "cubic stiffness";
  static constexpr Text kEquation = "F = k_3 |u|^2 u";
  static constexpr Text kSource = "next odd term of an isotropic elastic law";
  enum { kStiffness };
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m3", -1e20, 1e20, 0, 2e7}};

  static void step(const auto& term, auto& q) {
    const auto u = displacement_of(q);
    add(q, u * (term.parameters[kStiffness] * dot(u, u)));
  }
};

struct AsymmetricStiffness : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "asymmetric_stiffness";
  static constexpr Text kTitle = "stiffness that differs by direction";
  static constexpr Text kEquation = "F = k_2 u^2 on each axis";
  static constexpr Text kSource = "first even term of an elastic law";
  enum { kStiffness };
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m2", -1e18, 1e18, 0, 1e6}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return term.parameters[kStiffness] * q.displacement[axis] * q.displacement[axis];
  }
};

struct PDelta : Acts<Stage::Restoring, kFrameIndifferent> {
  static constexpr Text kName = "p_delta";
  static constexpr Text kTitle = "P-delta force";
  static constexpr Text kEquation = "F = k_L N u/h,  k_L < 0 pushes outwards";
  static constexpr Text kSource = "equilibrium in the displaced position";
  enum { kCoefficient, kHeight };
  static constexpr Parameter kParameters[] = {{"coefficient", "-", -10, 10, 0, -0.05},
                                              {"height", "m", 1e-3, 100, 0.37, 0.37}};

  static void step(const auto& term, auto& q) {
    const auto* p = term.parameters;
    add(q, displacement_of(q) * (p[kCoefficient] * q.axial_load / p[kHeight]));
  }
};

struct ViscoelasticRelaxation : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "viscoelastic_relaxation";
  static constexpr Text kTitle = "viscoelastic relaxation (Maxwell branch)";
  static constexpr Text kEquation = "dF/dt = k du/dt - F/tau";
  static constexpr Text kSource = "Maxwell 1867; exact for u linear within a step";
  enum { kStiffness, kTime };
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m", 0, 1e15, 0, 1e6},
                                              {"relaxation_time", "s", 1e-3, 1e4, 1, 1}};
  static constexpr std::size_t kStates = 4;  // displacement before, force

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real ratio = term.time_step / term.parameters[kTime];
    const Real decay = exp(-ratio);
    const Real intake = term.parameters[kStiffness] * (1 - decay) / ratio;
    const Plane<Real> u = displacement_of(q);
    const Plane<Real> du = u - Plane<Real>{term.state[0], term.state[1]};
    const Plane<Real> force = Plane<Real>{term.state[2], term.state[3]} * decay + du * intake;
    term.state[0] = u.x, term.state[1] = u.y;
    term.state[2] = force.x, term.state[3] = force.y;
    add(q, force);
  }
};

struct ViscousDamping : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "viscous_damping";
  static constexpr Text kTitle = "viscous damping of the bearing";
  static constexpr Text kEquation = "F = c v";
  static constexpr Text kSource = "Newton's law";
  enum { kDamping };
  static constexpr Parameter kParameters[] = {{"damping", "N*s/m", 0, 1e13, 0, 1e5}};

  static void step(const auto& term, auto& q) {
    add(q, velocity_of(q) * term.parameters[kDamping]);
  }
};

}  // namespace

std::span<const TermKind> elastomeric_restoring_kinds() {
  return kinds_of<LargeStrainStiffening, CubicStiffness, AsymmetricStiffness, PDelta,
                  ViscoelasticRelaxation, ViscousDamping>();
}

}  // namespace rths::sim
