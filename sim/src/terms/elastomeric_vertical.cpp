// SPDX-License-Identifier: Apache-2.0
// The vertical behaviour of elastomeric bearings: docs/theory/lead_rubber.md, "Vertical".
#include <numbers>

#include "elastomeric.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

struct BucklingLoadVariation : Acts<Stage::Vertical, kFrameIndifferent> {
  static constexpr Text kName = "buckling_load_variation";
  static constexpr Text kTitle = "buckling load reduced by displacement (overlap area)";
  static constexpr Text kEquation =
      "P_cr = P_cr0 max((delta - sin delta)/pi, residual),  delta = 2 acos(|u|/D_2)";
  static constexpr Text kSource = "Warn & Whittaker 2006, as in Kumar et al. 2014";
  enum { kCriticalLoad, kDiameter, kResidual };
  static constexpr Parameter kParameters[] = {
      {"critical_load", "N", 0, 1e12, 0, 5e7},  // 0: none
      {"outer_diameter", "m", 0, 10, 0, 1.35},  // 0: the load does not vary
      {"residual_ratio", "-", 0, 1, 0.2, 0.2}};

  static void step(const auto& term, auto& q) {
    q.buckling_load = term.parameters[kCriticalLoad];
    if (term.parameters[kDiameter] > 0) q.buckling_load *= overlap(term, q);
  }

  template <class Real>
  static Real overlap(const TermView<Real>& term, const Quantities<Real>& q) {
    const Real& residual = term.parameters[kResidual];
    const Real offset = length(displacement_of(q)) / term.parameters[kDiameter];
    if (!(offset < 1)) return residual;
    // sin delta = 2 sin(delta/2) cos(delta/2)
    const Real area =
        (acos(offset) - offset * sqrt(1 - offset * offset)) * Real{2 / std::numbers::pi};
    return area > residual ? area : residual;
  }
};

struct VerticalStiffnessVariation : Acts<Stage::Vertical, kFrameIndifferent> {
  static constexpr Text kName = "vertical_stiffness_variation";
  static constexpr Text kTitle = "vertical stiffness that falls with displacement";
  static constexpr Text kEquation = "K_v = K_v0 / (1 + (3/pi^2) (|u|/r_g)^2)";
  static constexpr Text kSource = "Warn, Whittaker & Constantinou 2007";
  enum { kRadiusOfGyration };
  static constexpr Parameter kParameters[] = {
      {"radius_of_gyration", "m", 0, 10, 0, 0.35}};  // 0: none

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real& radius = term.parameters[kRadiusOfGyration];
    if (!(radius > 0)) return;
    const Plane<Real> u = displacement_of(q);
    constexpr double kFactor = 3 / (std::numbers::pi * std::numbers::pi);
    q.vertical_stiffness /= 1 + dot(u, u) * Real{kFactor} / (radius * radius);
  }
};

struct ElastomericAxial : Acts<Stage::Vertical, kFrameIndifferent> {
  static constexpr Text kName = "elastomeric_axial";
  static constexpr Text kTitle = "axial law with cavitation and buckling";
  static constexpr Text kEquation =
      "N = -K_v w - c dw/dt;  w > F_c/K_v: -F_c (1 + (1 - exp(-k_c (w - u_c)))/(k_c T_r)), "
      "lower after damage;  N > P_cr: slope times ratio";
  static constexpr Text kSource = "Gent 1990; Kumar, Whittaker & Constantinou 2014";
  enum { kStiffness, kDamping, kCavitation, kDecay, kThickness, kDamage, kDamageRate, kBuckled };
  static constexpr Parameter kParameters[] = {
      {"vertical_stiffness", "N/m", 0, 1e12, 0, 5e9},  // 0: the axial load is unchanged
      {"vertical_damping", "N*s/m", 0, 1e10, 0, 1e7},
      {"cavitation_force", "N", 0, 1e10, 0, 3e6},  // 0: none
      {"post_cavitation_decay", "1/m", 1e-3, 1e4, 10, 10},
      {"rubber_thickness", "m", 1e-3, 10, 0.25, 0.25},
      {"cavitation_damage", "-", 0, 1, 0.5, 0.5},
      {"damage_rate", "-", 0, 100, 1, 1},
      {"buckled_stiffness_ratio", "-", 0, 1, 1, 1e-4}};  // 1: no buckling
  static constexpr std::size_t kStates = 2;              // largest elongation, damage

  static void step(const auto& term, auto& q) {
    const auto stiffness = term.parameters[kStiffness] * q.vertical_stiffness;
    if (!(stiffness > 0)) return;
    const auto& w = q.vertical_displacement;
    if (w > 0)
      q.axial_load = -tension(term, stiffness, w);
    else
      q.axial_load = compression(term, stiffness, -w, q.buckling_load);
    q.axial_load -= term.parameters[kDamping] * q.vertical_velocity;
  }

  template <class Real>
  static Real compression(const TermView<Real>& term, const Real& stiffness, const Real& shortening,
                          const Real& buckling_load) {
    const Real load = stiffness * shortening;
    if (!(buckling_load > 0) || load <= buckling_load) return load;
    return buckling_load + term.parameters[kBuckled] * (load - buckling_load);
  }

  template <class Real>
  static Real tension(const TermView<Real>& term, const Real& stiffness, const Real& elongation) {
    const Real* p = term.parameters;
    if (!(p[kCavitation] > 0)) return stiffness * elongation;
    Real& largest = term.state[0];
    Real& damage = term.state[1];
    const Real onset = p[kCavitation] / stiffness;
    const auto envelope = [&](const Real& w) -> Real {
      return p[kCavitation] *
             (1 + (1 - exp(-p[kDecay] * (w - onset))) / (p[kDecay] * p[kThickness]));
    };
    const Real reached = largest > onset ? largest : onset;
    if (elongation >= reached) {
      largest = elongation;
      const Real done = p[kDamage] * (1 - exp(-p[kDamageRate] * (elongation - onset) / onset));
      if (done > damage) damage = done;  // a moving onset does not reduce damage
      return envelope(elongation);
    }
    const Real damaged = p[kCavitation] * (1 - damage);
    const Real elastic = stiffness * elongation;
    if (elastic <= damaged) return elastic;
    const Real from = damaged / stiffness;
    return damaged + (envelope(reached) - damaged) * (elongation - from) / (reached - from);
  }
};

}  // namespace

std::span<const TermKind> elastomeric_vertical_kinds() {
  return kinds_of<BucklingLoadVariation, VerticalStiffnessVariation, ElastomericAxial>();
}

}  // namespace rths::sim
