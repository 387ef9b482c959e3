// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "opensees_rows.hpp"

namespace rths::sim::test_support {
namespace {

using nlohmann::json;

constexpr double kSliderLoad = 9.7e6;         // [N]
constexpr double kInitialStiffness = 4e8;     // before sliding [N/m]
constexpr double kVerticalStiffness = 1e10;   // [N/m]
constexpr double kFast = 0.11, kSlow = 0.06;  // friction coefficients [-]
constexpr double kRate = 30;                  // of the transition between them [s/m]

// The element is on a vertical spring without tension; iterations end at 1 mN.
OpenSeesRow slider(const std::string& name, json element, const json& friction) {
  OpenSeesRow row;
  row.name = name;
  row.bearing.element = std::move(element);
  append(row.bearing.element,
         {"-T", 2, "-My", 2, "-Mz", 2, "-orient", 0, 0, 1, 1, 0, 0, "-iter", 50, 1e-3});
  row.bearing.friction_models = json::array({friction});
  row.bearing.materials = json::array({{"ENT", 1, kVerticalStiffness}, {"Elastic", 2, 1e6}});
  row.bearing.axial_load = kSliderLoad;
  row.bearing.vertical_stiffness = kVerticalStiffness;
  return row;
}

const json kCoulomb = {"Coulomb", 1, kFast};
const json kVelocityDependent = {"VelDependent", 1, kSlow, kFast, kRate};

TermSettings flat() {
  return {"flat_slider",
          "",
          {{"friction_coefficient", kFast}, {"initial_stiffness", kInitialStiffness}}};
}

TermSettings pendulum(double radius, double initial_stiffness = kInitialStiffness) {
  return {"single_pendulum",
          "",
          {{"friction_coefficient", kFast},
           {"initial_stiffness", initial_stiffness},
           {"effective_radius", radius}}};
}

TermSettings velocity_dependent() {
  return {
      "velocity_dep_sliding", "", {{"low_velocity_reduction", 1 - kSlow / kFast}, {"rate", kRate}}};
}

OpenSeesRow flat_coulomb() {
  auto row =
      slider("flatSliderBearing", {"flatSliderBearing", 1, kInitialStiffness, "-P", 1}, kCoulomb);
  row.bearing.terms = {flat()};
  return row;
}

OpenSeesRow flat_velocity_dependent() {
  auto row = slider("flatSliderBearingVelDependent",
                    {"flatSliderBearing", 1, kInitialStiffness, "-P", 1}, kVelocityDependent);
  row.bearing.terms = {flat(), velocity_dependent()};
  return row;
}

OpenSeesRow single_pendulum(const std::string& name, double amplitude) {
  constexpr double kRadius = 2.2;  // [m]
  auto row =
      slider(name, {"singleFPBearing", 1, kRadius, kInitialStiffness, "-P", 1}, kVelocityDependent);
  // Before sliding, OpenSees' stiffness is that of the whole bearing, ours that of friction alone.
  row.bearing.terms = {pendulum(kRadius, kInitialStiffness - kSliderLoad / kRadius),
                       velocity_dependent()};
  row.amplitude = amplitude;
  return row;
}

OpenSeesRow steep_pendulum() {
  OpenSeesRow row = single_pendulum("singleFPBearingFarOut", 0.2);
  row.bound = 0.012;
  row.deviation = "ours assumes small slopes; OpenSees adds F.u/R to the load, 1 % at u/R = 0.1";
  return row;
}

OpenSeesRow eradiquake() {
  constexpr double kSpring = 1.2e7;  // [N/m]
  auto row = slider("RJWatsonEqsBearing",
                    {"RJWatsonEqsBearing", 1, kInitialStiffness, "-P", 1, "-Vy", 3, "-Vz", 3},
                    kVelocityDependent);
  row.bearing.materials.push_back({"Elastic", 3, kSpring});
  row.bearing.terms = {flat(), velocity_dependent(), {"mer_spring", "", {{"stiffness", kSpring}}}};
  return row;
}

// The element does not converge with velocity-dependent friction. Before sliding, OpenSees gives
// each of the three sliders the stiffness 3 mu_1/u_y, ours mu_i/u_y; the total stiffness is the
// same.
OpenSeesRow triple_pendulum(const std::string& name, double amplitude) {
  constexpr double kYield = 3e-4;                       // in OpenSees [m]
  constexpr double kLengths[] = {0.4, 2, 2};            // [m]
  constexpr double kCapacities[] = {0.05, 0.25, 0.25};  // [m]
  constexpr double kFrictions[] = {0.02, 0.06, 0.1};    // [-]
  constexpr double kTension = 1e8, kLeastLoad = 1e3, kTolerance = 1e-5;
  OpenSeesRow row;
  row.name = name;
  row.amplitude = amplitude;
  row.bearing.axial_load = kSliderLoad;
  row.bearing.vertical_stiffness = kVerticalStiffness;
  row.bearing.materials = json::array({{"ENT", 1, kVerticalStiffness}, {"Elastic", 2, 1e6}});
  row.bearing.element = {"TripleFrictionPendulum", 1, 2, 3, 1, 2, 2, 2};
  TermSettings term{"triple_pendulum", "", {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = static_cast<int>(i + 1);
    const std::string suffix = "_" + std::to_string(number);
    row.bearing.friction_models.push_back({"Coulomb", number, kFrictions[i]});
    term.parameters.emplace_back("radius" + suffix, kLengths[i]);
    term.parameters.emplace_back("capacity" + suffix, kCapacities[i]);
    term.parameters.emplace_back("friction" + suffix, kFrictions[i]);
    // OpenSees: stiffness 3 mu_1/u_y of each slider before it slides.
    term.parameters.emplace_back("yield_displacement" + suffix,
                                 kYield * kFrictions[i] / (3 * kFrictions[0]));
  }
  append(row.bearing.element, kLengths);
  append(row.bearing.element, kCapacities);
  append(row.bearing.element, {kSliderLoad, kYield, kTension, kLeastLoad, kTolerance});
  row.bearing.terms = {term};
  return row;
}

// Friction that depends on the surface's temperature only.
OpenSeesRow heated_pendulum(const std::string& name, double initial_stiffness) {
  constexpr double kRadius = 2.2, kContactRadius = 0.3, kPressure = 5e7;
  constexpr double kDiffusivity = 4.44e-6, kConductivity = 18;
  auto row = slider(name,
                    {"FPBearingPTV",
                     kFast,
                     0,
                     kPressure,
                     1,
                     kDiffusivity,
                     kConductivity,
                     0,
                     kRate,
                     kRadius,
                     kContactRadius,
                     initial_stiffness,
                     1,
                     2,
                     2,
                     2,
                     0,
                     0,
                     1,
                     1,
                     0,
                     0,
                     0.0,
                     0,
                     0.0,
                     50,
                     1e-3,
                     1},
                    kCoulomb);
  row.bearing.element.erase(row.bearing.element.begin() + 28, row.bearing.element.end());
  row.time_step = 1e-3;  // OpenSees sums over its whole history in every step
  row.bearing.terms = {pendulum(kRadius, initial_stiffness),
                       {"friction_heating",
                        "",
                        {{"heat_share", 1},
                         {"contact_area", std::numbers::pi * kContactRadius * kContactRadius},
                         {"conductivity", kConductivity},
                         {"diffusivity", kDiffusivity}}}};
  return row;
}

// Ten times its yield displacement per step.
OpenSeesRow stiff_heated_pendulum() {
  OpenSeesRow row = heated_pendulum("FPBearingPTV", 1e10);
  row.bound = 0.012;
  row.deviation = "OpenSees takes the whole step at once; half the difference at half the step";
  return row;
}

OpenSeesRow soft_heated_pendulum() {
  OpenSeesRow row = heated_pendulum("FPBearingPTVSoft", kInitialStiffness);
  row.bound = 0.06;
  row.deviation = "ours is heated by its work, OpenSees by mu p |v| even while it sticks";
  return row;
}

}  // namespace

std::vector<OpenSeesRow> sliding_rows() {
  return {flat_coulomb(),
          flat_velocity_dependent(),
          single_pendulum("singleFPBearing", 0.1),
          steep_pendulum(),
          eradiquake(),
          stiff_heated_pendulum(),
          soft_heated_pendulum(),
          triple_pendulum("TripleFrictionPendulum", 0.3),
          triple_pendulum("TripleFrictionPendulumAtStops", 0.58)};
}

}  // namespace rths::sim::test_support
