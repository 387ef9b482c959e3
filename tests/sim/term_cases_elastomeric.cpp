// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test_support {
namespace {

// A small bearing, so that displacements reach the minimum overlap.
TermCase buckling() {
  TermCase c;
  c.kind = "buckling_load_variation";
  c.term.parameters = {{"critical_load", 6e7}, {"outer_diameter", 0.3}, {"residual_ratio", 0.35}};
  c.companions = {lead_rubber(), {"horizontal_stiffness_variation", "", {{"coefficient", 1}}}};
  return c;
}

TermCase vertical_stiffness() {
  TermCase c;
  c.kind = "vertical_stiffness_variation";
  c.companions = {{"elastomeric_axial", "", {{"vertical_stiffness", 5e9}}}};
  return c;
}

// Soft, so that one motion reaches cavitation, its decay and buckling; mostly compressed, so that
// damage grows over several cycles. The noise is relative to the load's scatter, which is small
// when buckling limits the load. The rubber's thickness is known from the drawing and hardly
// identifiable besides the decay.
TermCase axial() {
  TermCase c;
  c.kind = "elastomeric_axial";
  c.term.parameters = {
      {"vertical_stiffness", 5e8}, {"damage_rate", 0.2}, {"buckled_stiffness_ratio", 0.05}};
  c.companions = {{"buckling_load_variation", "", {{"critical_load", 1e7}}}};
  c.fixed = {"rubber_thickness"};
  c.motion.vertical_offset = -0.04;
  c.motion.vertical_amplitude = 0.1;
  c.noise = 0.002;
  return c;
}

TermCase horizontal_stiffness() {
  TermCase c;
  c.kind = "horizontal_stiffness_variation";
  c.companions = {lead_rubber(), {"buckling_load_variation", "", {{"critical_load", 3e7}}}};
  return c;
}

TermCase ageing() {
  TermCase c;
  c.kind = "ageing_temperature";
  c.companions = {lead_rubber()};
  c.motion.temperature = 20;
  return c;
}

// A run long enough for cooling.
TermCase adiabatic() {
  TermCase c;
  c.kind = "adiabatic_heating";
  c.term.parameters = {{"cooling_time", 20}};
  c.companions = {lead_rubber()};
  c.motion.time_step = 0.02;
  c.motion.steps = 1000;
  return c;
}

// Dimensions are known from the drawing. Data determine only the ratio of softening to heat
// capacity, and lead's capacity is well known. Of steel's conductivity and diffusivity, one is
// fitted.
TermCase lead_heating() {
  TermCase c;
  c.kind = "lead_heating";
  c.fixed = {"lead_radius",        "lead_height",       "shim_thickness",
             "lead_heat_capacity", "steel_diffusivity", "elastic_share"};
  c.companions = {lead_rubber()};
  c.motion.time_step = 0.04;
  c.motion.steps = 1000;
  return c;
}

// Only the ratio to the height has an effect.
TermCase p_delta() {
  TermCase c;
  c.kind = "p_delta";
  c.fixed = {"height"};
  return c;
}

}  // namespace

std::vector<TermCase> elastomeric_cases() {
  return {buckling(), vertical_stiffness(), axial(),        horizontal_stiffness(),
          ageing(),   adiabatic(),          lead_heating(), p_delta()};
}

}  // namespace rths::sim::test_support
