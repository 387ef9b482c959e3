// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/lead_rubber_design.hpp>

#include "opensees_rows.hpp"

namespace rths::sim::test_support {

void append(nlohmann::json& to, const nlohmann::json& more) {
  for (const auto& word : more) to.push_back(word);
}

// A lead-rubber bearing of the paper's size, 1,010 kN and 4.2 MN/m after yield, but slender and
// under a third of its critical load, so that effects of the load are visible.
LeadRubberDesign compared_design() {
  LeadRubberDesign d;
  d.outer_diameter = 1.2;
  d.lead_diameter = 0.35;
  d.rubber_layers = 23;
  d.layer_thickness = 0.01;
  d.shim_thickness = 0.003;
  d.shear_modulus = 0.93e6;
  d.characteristic_strength = 1.01e6;
  d.stiffness_ratio = 0.0118;
  return d;
}

namespace {

using nlohmann::json;

constexpr double kRubberLoad = 25e6;  // [N]

// Flags of LeadRubberX in its order.
json flags(const LeadRubberEffects& effects) {
  json numbers = json::array();
  for (const bool flag :
       {effects.cavitation, effects.buckling_load_variation, effects.horizontal_stiffness_variation,
        effects.vertical_stiffness_variation, effects.lead_heating})
    numbers.push_back(flag ? 1 : 0);
  return numbers;
}

// The first arguments of LeadRubberX and ElastomericX, up to c_d and t_c.
json rubber_element(const char* name, const LeadRubberDesign& d) {
  return {name,
          d.characteristic_strength,
          d.stiffness_ratio,
          d.shear_modulus,
          d.bulk_modulus,
          d.lead_diameter,
          d.outer_diameter,
          d.shim_thickness,
          d.layer_thickness,
          d.rubber_layers,
          0,  // local x is the global z, local y the global x
          0,
          1,
          1,
          0,
          0,
          d.post_cavitation_decay,
          d.cavitation_damage,
          d.damage_rate,
          0.5,  // fraction of the height at which the shear acts
          0,    // mass
          d.horizontal_damping,
          d.cover};
}

// Replaces bouc_wen by Nagarajaiah's form, which uses the sign of each axis.
std::vector<TermSettings> as_theirs(std::vector<TermSettings> terms) {
  for (auto& term : terms)
    if (term.kind == "bouc_wen") term.kind = "bouc_wen_nagarajaiah";
  return terms;
}

OpenSeesRow rubber_row(const std::string& name, const LeadRubberEffects& effects,
                       const LeadRubberDesign& d = compared_design()) {
  OpenSeesRow row;
  row.name = name;
  row.bearing.element = rubber_element("LeadRubberX", d);
  append(row.bearing.element,
         {d.lead_density, d.lead_specific_heat, d.steel_conductivity, d.steel_diffusivity});
  append(row.bearing.element, flags(effects));
  row.bearing.axial_load = kRubberLoad;
  row.bearing.vertical_stiffness = vertical_stiffness(d);
  row.bearing.terms = as_theirs(terms_of(d, effects));
  row.swing = effects.cavitation ? 1 : 0;
  return row;
}

constexpr LeadRubberEffects kNone{false, false, false, false, false};

OpenSeesRow frame_indifferent() {
  OpenSeesRow row = rubber_row("LeadRubberXAgainstBoucWen", kNone);
  row.bearing.terms = terms_of(compared_design(), kNone);
  row.bound = 0.15;
  row.deviation = "ours is frame-indifferent, OpenSees uses the sign of each axis separately";
  return row;
}

// Heated by force times path, as in OpenSees.
OpenSeesRow heated(const std::string& name, const LeadRubberEffects& effects,
                   const LeadRubberDesign& d) {
  OpenSeesRow row = rubber_row(name, effects, d);
  for (auto& term : row.bearing.terms)
    if (term.kind == "lead_heating") term.parameters.emplace_back("elastic_share", 1.0);
  return row;
}

// With steel that absorbs no heat, both implement the same law.
OpenSeesRow heated_without_loss(const std::string& name, const LeadRubberEffects& effects) {
  LeadRubberDesign d = compared_design();
  d.steel_conductivity = 0;
  return heated(name, effects, d);
}

OpenSeesRow heated_and_cooled(const std::string& name, const LeadRubberEffects& effects) {
  OpenSeesRow row = heated(name, effects, compared_design());
  row.bound = 0.01;
  row.deviation =
      "ours stores the history of heat, OpenSees uses the time since the analysis began";
  return row;
}

OpenSeesRow heated_by_work() {
  OpenSeesRow row = rubber_row("LeadRubberXHeatingByWork", {false, false, false, false, true});
  row.bound = 0.03;
  row.deviation =
      "ours is heated by its work, OpenSees by force times path: OpenseesHeating separates them";
  return row;
}

OpenSeesRow beyond_buckling() {
  OpenSeesRow row = rubber_row("LeadRubberXBeyondBuckling", {true, true, true, true, false});
  row.swing = 3.2;
  row.bound = 0.5;
  row.deviation = "OpenSees keeps the lowest critical load so far, ours uses the present one";
  return row;
}

OpenSeesRow elastomeric_x() {
  LeadRubberDesign d = compared_design();
  d.lead_diameter = 0;  // with a hole OpenSees uses another shape factor
  OpenSeesRow row = rubber_row("ElastomericX", kNone);
  row.bearing.element = rubber_element("ElastomericX", d);
  append(row.bearing.element, {0, 0, 0, 0});
  row.bearing.vertical_stiffness = vertical_stiffness(d);
  row.bearing.terms = as_theirs(terms_of(d, kNone));
  return row;
}

// Materials of the directions outside the comparison: stiff in compression without tension, and an
// arbitrary stiffness for rotations.
OpenSeesRow bouc_wen_element() {
  const LeadRubberDesign d = compared_design();
  OpenSeesRow row;
  row.name = "elastomericBearingBoucWen";
  row.bearing.element = {row.name,
                         initial_stiffness(d),
                         d.characteristic_strength,
                         d.stiffness_ratio,
                         0.0,
                         1.0,
                         2.0,
                         0.5,
                         0.5};
  append(row.bearing.element, {"-P", 1, "-T", 2, "-My", 2, "-Mz", 2, "-orient", 0, 0, 1, 1, 0, 0});
  row.bearing.materials = json::array({{"ENT", 1, 1e10}, {"Elastic", 2, 1e6}});
  row.bearing.axial_load = kRubberLoad;
  row.bearing.vertical_stiffness = 1e10;
  row.bearing.terms = {{"bouc_wen",
                        "",
                        {{"characteristic_strength", d.characteristic_strength},
                         {"post_yield_stiffness", post_yield_stiffness(d)},
                         {"yield_displacement", yield_displacement(d)},
                         {"beta", 0.5},
                         {"eta", 2}}}};
  return row;
}

}  // namespace

TwoBearings heated_bearing() {
  return rubber_row("LeadRubberXHeating", {false, false, false, false, true}).bearing;
}

std::vector<OpenSeesRow> elastomeric_rows() {
  return {bouc_wen_element(),
          elastomeric_x(),
          rubber_row("LeadRubberX", kNone),
          rubber_row("LeadRubberXCavitation", {true, false, false, false, false}),
          rubber_row("LeadRubberXBucklingLoad", {false, true, false, false, false}),
          rubber_row("LeadRubberXHorizontalStiffness", {false, false, true, false, false}),
          rubber_row("LeadRubberXVerticalStiffness", {false, false, false, true, false}),
          rubber_row("LeadRubberXFourEffects", {true, true, true, true, false}),
          beyond_buckling(),
          heated_without_loss("LeadRubberXHeating", {false, false, false, false, true}),
          heated_without_loss("LeadRubberXAllEffects", {true, true, true, true, true}),
          heated_and_cooled("LeadRubberXHeatingAndCooling", {false, false, false, false, true}),
          heated_and_cooled("LeadRubberXAllEffectsAndCooling", {true, true, true, true, true}),
          heated_by_work(),
          frame_indifferent()};
}

}  // namespace rths::sim::test_support
