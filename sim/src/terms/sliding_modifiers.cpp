// SPDX-License-Identifier: Apache-2.0
#include "fading_memory.hpp"
#include "sliding.hpp"

namespace rths::sim {
namespace {

constexpr double kPressureStep = 50e6;  // of pressure_dep_sliding [Pa]

struct VelocityDepSliding : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "velocity_dep_sliding";
  static constexpr Text kTitle = "friction that grows with velocity";
  static constexpr Text kEquation = "mu = mu_f (1 - x exp(-a |v|)),  x = 1 - mu_s/mu_f";
  static constexpr Text kSource = "Constantinou, Mokha & Reinhorn 1990";
  enum { kReduction, kRate };
  static constexpr Parameter kParameters[] = {{"low_velocity_reduction", "-", 0, 1, 0, 0.5},
                                              {"rate", "s/m", 0, 1e7, 100, 20}};

  static void step(const auto& term, auto& q) {
    const auto speed = length(velocity_of(q));
    q.strength *= 1 - term.parameters[kReduction] * exp(-(term.parameters[kRate] * speed));
  }
};

struct PressureDepSliding : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "pressure_dep_sliding";
  static constexpr Text kTitle = "friction that falls with pressure";
  static constexpr Text kEquation = "mu = mu_0 f^((p - p_0)/50 MPa),  p = N/A";
  static constexpr Text kSource = "Kumar, Whittaker & Constantinou 2015, f = 0.7";
  enum { kFactor, kReference, kArea };
  static constexpr Parameter kParameters[] = {{"factor_at_50_MPa", "-", 0.01, 10, 1, 0.7},
                                              {"reference_pressure", "Pa", 0, 1e9, 0, 30e6},
                                              {"contact_area", "m2", 1e-10, 1e4, 0.25, 0.25}};

  static void step(const auto& term, auto& q) {
    const auto pressure = contact_load(q) / term.parameters[kArea];
    const auto excess = (pressure - term.parameters[kReference]) * (1 / kPressureStep);
    q.strength *= pow(term.parameters[kFactor], excess);
  }
};

struct PressureTanhSliding : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "pressure_tanh_sliding";
  static constexpr Text kTitle = "friction that falls with pressure and levels off";
  static constexpr Text kEquation = "mu = mu_0 (1 - x tanh(p/p_s)),  p = N/A";
  static constexpr Text kSource = "Tsopelas, Constantinou & Reinhorn 1994";
  enum { kReduction, kScale, kArea };
  static constexpr Parameter kParameters[] = {{"high_pressure_reduction", "-", 0, 1, 0, 0.5},
                                              {"pressure_scale", "Pa", 1e3, 1e10, 50e6, 50e6},
                                              {"contact_area", "m2", 1e-10, 1e4, 0.25, 0.25}};

  static void step(const auto& term, auto& q) {
    const auto pressure = contact_load(q) / term.parameters[kArea];
    q.strength *= 1 - term.parameters[kReduction] * tanh(pressure / term.parameters[kScale]);
  }
};

// The heat of a step is the last step's friction times this step's velocity.
struct FrictionHeating : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "friction_heating";
  static constexpr Text kTitle = "friction that falls with the surface's temperature";
  static constexpr Text kEquation =
      "mu = mu_20 (r + (1 - r) exp(-(T - 20)/T_s)),  T = 20 + T_air + share sqrt(D/pi)/k int "
      "q/sqrt(s),"
      "  q = max(0, F.v)/A while |u| < sqrt(A)/2";
  static constexpr Text kSource = "Kumar, Whittaker & Constantinou 2015";
  enum { kShare, kResidual, kScale, kArea, kConductivity, kDiffusivity };
  static constexpr Parameter kParameters[] = {
      {"heat_share", "-", 0, 1, 0, 0.9},
      {"residual_friction", "-", 0, 1, kResidualFriction, kResidualFriction},
      {"temperature_scale", "degC", 1, 1e4, kTemperatureScale, kTemperatureScale},
      {"contact_area", "m2", 1e-10, 1e4, 0.25, 0.25},
      {"conductivity", "W/m/degC", 0.1, 1000, kSteelConductivity, kSteelConductivity},
      {"diffusivity", "m2/s", 1e-8, 1e-2, kSteelDiffusivity, kSteelDiffusivity}};

  static TermSize size(const TermSetup&) { return {kFadingStates, kFadingConstants}; }
  static void prepare(const TermSetup& setup, std::span<double> constants) {
    prepare_fading_memory(0.5, setup.time_step, constants);
  }

  // Heat flux into the monitored point in the middle of the surface.
  template <class Real>
  static Real flux(const TermView<Real>& term, const Quantities<Real>& q) {
    const Real& area = term.parameters[kArea];
    const Plane<Real> u = displacement_of(q);
    if (4 * dot(u, u) > area) return Real{0};
    const Real power =
        q.last_hysteretic_force[0] * q.velocity[0] + q.last_hysteretic_force[1] * q.velocity[1];
    return power > 0 ? Real{power / area} : Real{0};
  }

  static void step(const auto& term, auto& q) {
    const auto* p = term.parameters;
    const auto memory = remember(term.constants, term.state, flux(term, q));
    const auto rise =
        p[kShare] * sqrt(p[kDiffusivity] * (1 / std::numbers::pi)) / p[kConductivity] * memory;
    const auto hotter = rise + q.temperature;
    q.strength *= p[kResidual] + (1 - p[kResidual]) * exp(-(hotter / p[kScale]));
  }
};

}  // namespace

std::span<const TermKind> sliding_modifier_kinds() {
  return kinds_of<VelocityDepSliding, PressureDepSliding, PressureTanhSliding, FrictionHeating>();
}

}  // namespace rths::sim
