// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test_support {
namespace {

TermSettings slider() {
  return {"flat_slider", "", {{"friction_coefficient", 0.1}, {"initial_stiffness", 4e8}}};
}

// Modifiers of friction are tested on a slider. Dimensions are known from drawings.
TermCase modifier(const std::string& kind, std::vector<std::string> fixed) {
  TermCase c;
  c.kind = kind;
  c.companions = {slider()};
  c.fixed = std::move(fixed);
  return c;
}

TermCase vertical(const std::string& kind, std::vector<TermSettings> companions) {
  TermCase c;
  c.kind = kind;
  c.companions = std::move(companions);
  c.motion.axial_load = 0;
  return c;
}

// Strong heating: the contact covers the middle of the surface most of the time.
TermCase friction_heating() {
  // The friction depends only on the product of the share and the steel's properties over the
  // temperature scale. Steel properties and temperature law are tabulated.
  TermCase c = modifier("friction_heating",
                        {"contact_area", "conductivity", "diffusivity", "temperature_scale"});
  c.motion.amplitude = 0.12;
  return c;
}

// Compressed through both knees, and in tension.
TermCase multilinear() {
  TermCase c = vertical("multilinear_axial", {});
  c.motion.vertical_offset = -1.6e-3;
  c.motion.vertical_amplitude = 2.2e-3;
  c.noise = 0.003;
  return c;
}

TermCase lift() {
  return vertical("pendulum_lift", {{"multilinear_axial", "", {{"stiffness_1", 3e9}}}});
}

// Through all regimes into the stops of both outer surfaces. Dimensions are known from drawings.
TermCase triple_pendulum() {
  TermCase c;
  c.kind = "triple_pendulum";
  c.term.parameters = {{"capacity_1", 0.03}, {"capacity_2", 0.12}, {"capacity_3", 0.13}};
  c.fixed = {"radius_1",   "radius_2",       "radius_3",       "capacity_1",    "capacity_2",
             "capacity_3", "contact_area_1", "contact_area_2", "contact_area_3"};
  c.motion.amplitude = 0.25;
  c.noise = 0.003;
  return c;
}

}  // namespace

std::vector<TermCase> sliding_cases() {
  return {modifier("velocity_dep_sliding", {}),
          modifier("pressure_dep_sliding", {"contact_area"}),
          modifier("pressure_tanh_sliding", {"contact_area"}),
          friction_heating(),
          multilinear(),
          lift(),
          triple_pendulum()};
}

}  // namespace rths::sim::test_support
