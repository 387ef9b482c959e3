// SPDX-License-Identifier: Apache-2.0
// Modifiers of elastomeric bearings' strength and stiffness, except heating:
// docs/theory/lead_rubber.md, "Modifiers".

#include "elastomeric.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

struct HorizontalStiffnessVariation : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "horizontal_stiffness_variation";
  static constexpr Text kTitle = "stiffness that falls towards the buckling load";
  static constexpr Text kEquation = "K = K_0 max(0, 1 - c (N/P_cr)^2)";
  static constexpr Text kSource = "Koh & Kelly 1988, as in Kumar et al. 2014";
  enum { kCoefficient };
  static constexpr Parameter kParameters[] = {{"coefficient", "-", 0, 10, 0, 1}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    if (!(q.buckling_load > 0)) return;
    const Real ratio = q.axial_load / q.buckling_load;
    scale<Real>(q.stiffness, 1 - term.parameters[kCoefficient] * ratio * ratio);
  }
};

struct AxialLoadStrength : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "axial_load_strength";
  static constexpr Text kTitle = "strength that depends on the axial load";
  static constexpr Text kEquation = "Q = Q_0 f,  k = k_0 f^s,  f = max(0, 1 + k_Q (N - N_0)/N_0)";
  static constexpr Text kSource = "first-order; confinement of the lead plug";
  enum { kCoefficient, kReference, kElasticShare };
  static constexpr Parameter kParameters[] = {{"coefficient", "-", -10, 10, 0, 0.2},
                                              {"reference_load", "N", 1e-6, 1e10, 9.7e6, 9.7e6},
                                              kElasticShareParameter};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real* p = term.parameters;
    Real factor{1};
    scale<Real>(factor, 1 + p[kCoefficient] * (q.axial_load / p[kReference] - 1));
    weaken(q, factor, p[kElasticShare]);
  }
};

struct AxialLoadStiffness : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "axial_load_stiffness";
  static constexpr Text kTitle = "stiffness that depends on the axial load";
  static constexpr Text kEquation = "K = K_0 max(0, 1 - k_K ((N/N_0)^2 - 1))";
  static constexpr Text kSource = "Koh & Kelly 1988, about the load N_0 of the test";
  enum { kCoefficient, kReference };
  static constexpr Parameter kParameters[] = {{"coefficient", "-", -10, 10, 0, 0.05},
                                              {"reference_load", "N", 1e-6, 1e10, 9.7e6, 9.7e6}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real* p = term.parameters;
    const Real ratio = q.axial_load / p[kReference];
    scale<Real>(q.stiffness, 1 - p[kCoefficient] * (ratio * ratio - 1));
  }
};

struct Scragging : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "scragging";
  static constexpr Text kTitle = "virgin stiffness lost with peak displacement";
  static constexpr Text kEquation = "K = K_0 (1 + s exp(-u_max/u_s))";
  static constexpr Text kSource = "Mullins 1969; Thompson et al. 2000";
  enum { kExcess, kDisplacement };
  static constexpr Parameter kParameters[] = {
      {"virgin_excess", "-", 0, 10, 0, 0.2}, {"scragging_displacement", "m", 1e-7, 10, 0.05, 0.05}};
  static constexpr std::size_t kStates = 1;  // largest displacement

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real* p = term.parameters;
    Real& largest = term.state[0];
    const Real u = length(displacement_of(q));
    if (u > largest) largest = u;
    q.stiffness *= 1 + p[kExcess] * exp(-largest / p[kDisplacement]);
  }
};

struct RateDependentStrength : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "rate_dep_strength";
  static constexpr Text kTitle = "strength that grows with velocity";
  static constexpr Text kEquation = "Q = Q_0 f,  k = k_0 f^s,  f = 1 + r ln(1 + |v|/v_0)";
  static constexpr Text kSource = "logarithmic rate law; Robinson 1982 for lead";
  enum { kCoefficient, kVelocity, kElasticShare };
  static constexpr Parameter kParameters[] = {{"coefficient", "-", 0, 10, 0, 0.05},
                                              {"reference_velocity", "m/s", 1e-8, 10, 0.05, 0.05},
                                              kElasticShareParameter};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real* p = term.parameters;
    const Real speed = length(velocity_of(q));
    weaken<Real>(q, 1 + p[kCoefficient] * log1p(speed / p[kVelocity]), p[kElasticShare]);
  }
};

struct AgeingTemperature : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "ageing_temperature";
  static constexpr Text kTitle = "ageing and ambient temperature";
  static constexpr Text kEquation = "K = K_0 (1 + a_K) exp(-k_K T),  Q = Q_0 (1 + a_Q) exp(-k_Q T)";
  static constexpr Text kSource = "property modification factors, Constantinou et al. 2007";
  enum { kStiffnessAgeing, kStrengthAgeing, kStiffnessFall, kStrengthFall };
  static constexpr Parameter kParameters[] = {{"stiffness_ageing", "-", -0.9, 10, 0, 0.1},
                                              {"strength_ageing", "-", -0.9, 10, 0, 0.05},
                                              {"stiffness_temperature", "1/K", -1, 1, 0, 0.004},
                                              {"strength_temperature", "1/K", -1, 1, 0, 0.007}};

  static void step(const auto& term, auto& q) {
    const auto* p = term.parameters;
    q.stiffness *= (1 + p[kStiffnessAgeing]) * exp(-p[kStiffnessFall] * q.temperature);
    q.strength *= (1 + p[kStrengthAgeing]) * exp(-p[kStrengthFall] * q.temperature);
  }
};

}  // namespace

std::span<const TermKind> elastomeric_modifier_kinds() {
  return kinds_of<HorizontalStiffnessVariation, AxialLoadStrength, AxialLoadStiffness, Scragging,
                  RateDependentStrength, AgeingTemperature>();
}

}  // namespace rths::sim
