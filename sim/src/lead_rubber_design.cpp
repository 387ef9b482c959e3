// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/lead_rubber_design.hpp>

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

using std::numbers::pi;

double square(double x) { return x * x; }

double covered_diameter(const LeadRubberDesign& d) { return d.outer_diameter + d.cover; }

// Shims add height but no flexibility, so area and inertia are scaled by height / rubber thickness.
double shear_area(const LeadRubberDesign& d) {
  return rubber_area(d) * height(d) / rubber_thickness(d);
}
double inertia_over_height(const LeadRubberDesign& d) {
  return moment_of_inertia(d) * height(d) / rubber_thickness(d);
}

void check(const LeadRubberDesign& d) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw Error{
          fmt::format("lead-rubber design: {} is {}, expected a positive number", name, value)};
  };
  positive("outer_diameter", d.outer_diameter);
  positive("rubber_layers", d.rubber_layers);
  positive("layer_thickness", d.layer_thickness);
  positive("shear_modulus", d.shear_modulus);
  positive("bulk_modulus", d.bulk_modulus);
  if (!(d.lead_diameter >= 0 && d.lead_diameter < d.outer_diameter))
    throw Error{fmt::format("lead-rubber design: lead_diameter is {}, expected 0 to {}",
                            d.lead_diameter, d.outer_diameter)};
  if (!(d.stiffness_ratio > 0 && d.stiffness_ratio < 1))
    throw Error{fmt::format("lead-rubber design: stiffness_ratio is {}, expected 0 to 1",
                            d.stiffness_ratio)};
}

TermSettings hysteresis(const LeadRubberDesign& d) {
  // LeadRubberX's shape: 0.1 + 0.9 sgn in its notation.
  constexpr double kBeta = 0.9;
  return {"bouc_wen",
          "",
          {{"characteristic_strength", d.characteristic_strength},
           {"post_yield_stiffness", post_yield_stiffness(d)},
           {"yield_displacement", yield_displacement(d)},
           {"beta", kBeta}}};
}

TermSettings axial(const LeadRubberDesign& d, bool cavitates) {
  constexpr double kBuckledRatio = 1e-4;
  return {"elastomeric_axial",
          "",
          {{"vertical_stiffness", vertical_stiffness(d)},
           {"cavitation_force", cavitates ? cavitation_force(d) : 0},
           {"post_cavitation_decay", d.post_cavitation_decay},
           {"rubber_thickness", rubber_thickness(d)},
           {"cavitation_damage", d.cavitation_damage},
           {"damage_rate", d.damage_rate},
           {"buckled_stiffness_ratio", kBuckledRatio}}};
}

TermSettings heating(const LeadRubberDesign& d) {
  return {"lead_heating",
          "",
          {{"softening", d.softening},
           {"lead_radius", d.lead_diameter / 2},
           {"lead_height", height(d)},
           {"shim_thickness", (d.rubber_layers - 1) * d.shim_thickness},
           {"lead_heat_capacity", d.lead_density * d.lead_specific_heat},
           {"steel_conductivity", d.steel_conductivity},
           {"steel_diffusivity", d.steel_diffusivity}}};
}

}  // namespace

double rubber_area(const LeadRubberDesign& d) {
  return pi / 4 * (square(covered_diameter(d)) - square(d.lead_diameter));
}

double lead_area(const LeadRubberDesign& d) { return pi / 4 * square(d.lead_diameter); }

// The inner surface does not count as free: rubber cannot bulge into the plug.
double shape_factor(const LeadRubberDesign& d) {
  return (square(d.outer_diameter) - square(d.lead_diameter)) /
         (4 * d.outer_diameter * d.layer_thickness);
}

double rubber_thickness(const LeadRubberDesign& d) { return d.rubber_layers * d.layer_thickness; }

double height(const LeadRubberDesign& d) {
  return rubber_thickness(d) + (d.rubber_layers - 1) * d.shim_thickness;
}

double hole_factor(const LeadRubberDesign& d) {
  if (!(d.lead_diameter > 0)) return 1;
  const double r = d.outer_diameter / d.lead_diameter;
  return (r * r + 1) / square(r - 1) + (1 + r) / ((1 - r) * std::log(r));
}

double compression_modulus(const LeadRubberDesign& d) {
  const double sheared = 6 * d.shear_modulus * square(shape_factor(d)) * hole_factor(d);
  return 1 / (1 / sheared + 4 / (3 * d.bulk_modulus));
}

double rotation_modulus(const LeadRubberDesign& d) { return compression_modulus(d) / 3; }

double moment_of_inertia(const LeadRubberDesign& d) {
  return pi / 64 * (std::pow(covered_diameter(d), 4) - std::pow(d.lead_diameter, 4));
}

double radius_of_gyration(const LeadRubberDesign& d) {
  return std::sqrt(moment_of_inertia(d) / rubber_area(d));
}

double vertical_stiffness(const LeadRubberDesign& d) {
  return rubber_area(d) * compression_modulus(d) / rubber_thickness(d);
}

double post_yield_stiffness(const LeadRubberDesign& d) {
  return d.shear_modulus * rubber_area(d) / rubber_thickness(d);
}

double initial_stiffness(const LeadRubberDesign& d) {
  return post_yield_stiffness(d) / d.stiffness_ratio;
}

double yield_displacement(const LeadRubberDesign& d) {
  return d.characteristic_strength / (initial_stiffness(d) - post_yield_stiffness(d));
}

double torsional_stiffness(const LeadRubberDesign& d) {
  return 2 * d.shear_modulus * inertia_over_height(d) / height(d);
}

double rotational_stiffness(const LeadRubberDesign& d) {
  return rotation_modulus(d) * inertia_over_height(d) / height(d);
}

double euler_load(const LeadRubberDesign& d) {
  return square(pi / height(d)) * rotation_modulus(d) * inertia_over_height(d);
}

double critical_load(const LeadRubberDesign& d) {
  return std::sqrt(euler_load(d) * d.shear_modulus * shear_area(d));
}

double cavitation_force(const LeadRubberDesign& d) { return 3 * d.shear_modulus * rubber_area(d); }

std::vector<TermSettings> terms_of(const LeadRubberDesign& design,
                                   const LeadRubberEffects& effects) {
  check(design);
  const double diameter = effects.buckling_load_variation ? design.outer_diameter : 0;
  std::vector<TermSettings> terms{
      {"buckling_load_variation",
       "",
       {{"critical_load", critical_load(design)}, {"outer_diameter", diameter}}},
      axial(design, effects.cavitation),
      hysteresis(design)};
  if (design.horizontal_damping > 0)
    terms.push_back({"viscous_damping", "", {{"damping", design.horizontal_damping}}});
  if (effects.vertical_stiffness_variation)
    terms.push_back(
        {"vertical_stiffness_variation", "", {{"radius_of_gyration", radius_of_gyration(design)}}});
  if (effects.horizontal_stiffness_variation)
    terms.push_back({"horizontal_stiffness_variation", "", {{"coefficient", 1}}});
  if (effects.lead_heating && design.lead_diameter > 0) terms.push_back(heating(design));
  return terms;
}

}  // namespace rths::sim
