// SPDX-License-Identifier: Apache-2.0
#include "effects.hpp"

// Effects of specimen and machine that are in the library of the diagnosis. Sizes follow earlier
// trials where these have the effect.
namespace trial {
namespace {

Effect force_effect(std::string_view part, std::string_view name, std::vector<Draw> draws) {
  return {name, part, "force", Relation::Force, std::move(draws)};
}

}  // namespace

std::vector<Effect> bearing_effects() {
  const auto bearing = [](std::string_view name, std::vector<Draw> draws) {
    return force_effect("bearing", name, std::move(draws));
  };
  return {
      bearing("lead_heating", {{kHeating, 0.03, 0.15, kSize}, {kCooling, 0.002, 0.03}}),
      bearing("axial_load_strength", {{kAxialStrength, 0.05, 0.2, kSize}}),
      bearing("axial_load_stiffness", {{kAxialStiffness, 0.02, 0.08, kSize}}),
      bearing("p_delta", {{kPDelta, -0.06, -0.01, kSize}}),
      bearing("bidirectional_coupling", {{kCoupling, 0.4, 0.85, kSize}}),
      bearing("large_strain_stiffening",
              {{kStiffening, 4e5, 1.5e6, kSize}, {kStiffeningOnset, 0.07, 0.11}}),
      bearing("cubic_stiffness", {{kCubic, 4e6, 1.5e7, kSize}}),
      bearing("scragging", {{kScragging, 0.1, 0.3, kSize}, {kScraggingLength, 0.03, 0.08}}),
      bearing("rate_dep_strength", {{kRate, 0.015, 0.06, kSize}, {kRateVelocity, 0.005, 0.05}}),
      bearing("viscoelastic_relax", {{kMaxwell, 3e5, 9e5, kSize}, {kMaxwellRate, 0.3, 3}}),
      bearing("asymmetric_stiffness", {{kQuadraticX, 4e5, 1.5e6, kSize, kEitherSign},
                                       {kQuadraticY, 4e5, 1.5e6, kSize, kEitherSign}}),
      bearing("hysteresis_shape", {{kShape1, 4e3, 15e3, kSize, kEitherSign},
                                   {kShape2, 4e3, 15e3, kSize, kEitherSign},
                                   {kShape3, 4e3, 15e3, kSize, kEitherSign},
                                   {kShape4, 4e3, 15e3, kSize, kEitherSign}}),
  };
}

std::vector<Effect> machine_effects() {
  const auto machine = [](std::string_view name, std::vector<Draw> draws) {
    return force_effect("machine", name, std::move(draws));
  };
  const Draw presliding{kPresliding, 1e-4, 6e-4};
  return {
      machine("coulomb_friction",
              {{kFrictionX, 4e3, 18e3, kSize}, {kFrictionY, 4e3, 18e3, kSize}, presliding}),
      machine("viscous_friction", {{kViscousX, 10e3, 40e3, kSize}, {kViscousY, 10e3, 40e3, kSize}}),
      machine("quadratic_drag", {{kDrag, 15e3, 60e3, kSize}}),
      machine("load_dep_friction", {{kLoadFriction, 0.001, 0.004, kSize}, presliding}),
      machine("stribeck_breakaway", {{kFrictionX, 4e3, 10e3, kSize},
                                     {kFrictionY, 4e3, 10e3, kSize},
                                     {kBreakaway, 6e3, 20e3, kSize},
                                     {kStribeckVelocity, 0.01, 0.06},
                                     presliding}),
      machine("asymmetric_friction", {{kFrictionX, 6e3, 14e3, kSize},
                                      {kFrictionY, 6e3, 14e3, kSize},
                                      {kAsymmetryX, 2e3, 5e3, kSize, kEitherSign},
                                      {kAsymmetryY, 2e3, 5e3, kSize, kEitherSign},
                                      presliding}),
      machine("position_dependent_friction", {{kRub, 8e3, 25e3, kSize},
                                              {kRubPlace, 0, 0.06, false, kEitherSign},
                                              {kRubWidth, 0.015, 0.04},
                                              presliding}),
      machine("platen_inertia",
              {{kMassErrorX, 0.03, 0.12, kSize}, {kMassErrorY, 0.03, 0.12, kSize}}),
      machine("support_flexibility", {{kFlexibility, 1 / 8e8, 1 / 3e8, kSize}}),
      machine("transducer_backlash", {{kBacklash, 0.6e-3, 3e-3, kSize}}),
      machine("mount_slack", {{kSlack, 0.6e-3, 3e-3, kSize}}),
  };
}

std::vector<Effect> actuator_effects() {
  const auto actuator = [](std::string_view name, std::vector<Draw> draws) {
    return Effect{name, "actuator", "displacement", Relation::Actuator, std::move(draws)};
  };
  return {
      actuator("actuator_delay", {{kExtraDelay, 1e-3, 4e-3, kSize}}),
      actuator("actuator_bandwidth", {{kBandwidth, 0.8, 0.94, kSize}}),
      actuator("rate_saturation", {{kSpeedShare, 0.05, 0.3, kSize}}),
      actuator("valve_deadband", {{kDeadBand, 0.3e-3, 1.5e-3, kSize}}),
      actuator("oil_column_resonance",
               {{kOilTime, 5.3e-3, 8.8e-3, kSize}, {kOilDamping, 0.06, 0.15}}),
      actuator("load_compliance", {{kCompliance, 1 / 15e8, 1 / 6e8, kSize}}),
  };
}

}  // namespace trial
