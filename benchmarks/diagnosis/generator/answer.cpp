// SPDX-License-Identifier: Apache-2.0
#include "answer.hpp"

#include "json.hpp"
#include "truth.hpp"

namespace trial {
namespace {

void add_parameter(Json& json, Parameter parameter, double value) {
  json.open(info(parameter).name);
  json.add("value", value);
  json.add("unit", info(parameter).unit);
  json.add("absent", info(parameter).absent);
  json.close();
}

void add_place(Json& json, std::string_view key, const Place& place) {
  json.open(key);
  const auto add = [&](const std::string& name, const PlacedEnergy& energy) {
    json.add(name + "_cells", energy.cells);
    json.add(name + "_share", energy.share);
  };
  add("time", place.time);
  add("frequency", place.frequency);
  add("state", place.state);
  json.close();
}

void add_truth(Json& json, const EffectTruth& truth) {
  json.open("truth");
  json.add("energy_nat", truth.energy);
  json.add("information_nat", truth.information);
  json.add("detectable", truth.detectable());
  json.open("separation_nat");
  bool is_distinguishable = true;
  for (const Separation& separation : truth.separations) {
    json.add(separation.rival, separation.nats);
    is_distinguishable =
        is_distinguishable && (separation.contains_it || separation.nats >= kDistinguishable);
  }
  json.close();
  json.add("distinguishable", is_distinguishable);
  for (const bool contains_it : {false, true}) {
    json.open_list(contains_it ? "special_case_of" : "tie");
    for (const Separation& separation : truth.separations)
      if (separation.contains_it == contains_it && separation.nats < kDistinguishable)
        json.add("", separation.rival);
    json.close();
  }
  add_place(json, "place", truth.of_effect);
  add_place(json, "place_after_nuisances", truth.of_rest);
  json.close();
}

void add_effect(Json& json, const TrialCase& trial, const Effect& effect, TruthDepth depth) {
  json.open();
  json.add("name", effect.name);
  json.add("in_library", effect.home == Home::Library);
  json.add("part", effect.part);
  json.add("channel", effect.channel);
  if (!effect.form.empty()) json.add("form", effect.form);
  if (!effect.kin.empty()) json.add("term_that_describes_it", effect.kin);
  json.open("parameters");
  for (const Draw& draw : effect.draws)
    add_parameter(json, draw.parameter, trial.physics[draw.parameter]);
  if (effect.name == "loadcell_saturation")
    add_parameter(json, kClipLimit, trial.physics[kClipLimit]);
  if (effect.name == "rate_saturation")
    add_parameter(json, kSpeedLimit, trial.physics[kSpeedLimit]);
  json.close();
  if (depth == TruthDepth::Full) add_truth(json, truth_of(trial, effect, true));
  json.close();
}

void add_specimen(Json& json, const TrialCase& trial) {
  json.open("specimen");
  for (const Parameter parameter :
       {kStiffness, kStrength, kYieldDisplacement, kExponent, kBeta, kMixShare, kMixRatio})
    add_parameter(json, parameter, trial.physics[parameter]);
  json.add("reference_load_N", kReferenceLoad);
  json.close();
}

void add_noise(Json& json, std::string_view key, const NoiseColour& colour) {
  json.open(key);
  json.add("deviation", colour.deviation);
  json.add("share_of_variance", std::vector<double>(colour.share.begin(), colour.share.end()));
  json.add("corner_Hz", std::vector<double>(colour.corner_Hz.begin(), colour.corner_Hz.end()));
  json.close();
}

void add_records(Json& json, const TrialCase& trial) {
  json.open_list("records");
  for (std::size_t i = 0; i < trial.records.size(); ++i) {
    const Excitation& excitation = trial.excitations[i];
    json.open();
    json.add("ground_motion", excitation.ground_motion);
    json.add("scale", excitation.scale);
    json.add("components_swapped", excitation.swapped);
    json.add("vertical_recorded", excitation.has_vertical);
    json.add("force_offset_N",
             std::vector<double>(trial.offsets[i].begin(), trial.offsets[i].end()));
    json.add("peak_displacement_m", trial.records[i].peak_displacement());
    json.add("peak_force_N", trial.records[i].peak_force());
    json.add("peak_speed_m_per_s", trial.records[i].peak_speed());
    json.close();
  }
  json.close();
}

void add_cells(Json& json, double duration) {
  json.open("cells");
  json.add("time_s", duration / static_cast<double>(kTimeCells));
  json.add("frequency_edges_Hz", third_octaves());
  json.add("state_cells_per_side", double{kStateCells});
  json.add("state_displacement_m", kStateDisplacement);
  json.add("state_velocity_m_per_s", kStateVelocity);
  json.add("state_index", "displacement cell * cells per side + velocity cell");
  json.close();
}

std::string kind_of(const TrialCase& trial) {
  if (trial.hidden.empty()) return "none";
  if (trial.hidden.size() > 1) return "pair";
  return trial.hidden[0]->home == Home::Library ? "library" : "outside";
}

}  // namespace

std::string answer(const TrialCase& trial, TruthDepth depth) {
  Json json;
  json.open();
  json.add("format", 1.0);
  json.add("seed", static_cast<double>(trial.id.seed));
  json.add("case", static_cast<double>(trial.id.number));
  json.add("tier", std::string(1, letter_of(trial.id.tier)));
  json.add("kind", kind_of(trial));
  json.open_list("effects");
  for (const Effect* hidden : trial.hidden) add_effect(json, trial, *hidden, depth);
  json.close();
  add_specimen(json, trial);
  json.open("noise");
  add_noise(json, "displacement_m", trial.noise.displacement);
  add_noise(json, "acceleration_m_per_s2", trial.noise.acceleration);
  add_noise(json, "force_N", trial.noise.force);
  add_noise(json, "axial_load_N", trial.noise.axial_load);
  json.close();
  add_records(json, trial);
  if (depth == TruthDepth::Full) {
    const Floor floor = floor_of(trial);
    json.open("nrmse_on_unseen");
    json.add("oracle", floor.oracle);
    json.add("without_effects", floor.without);
    json.add("as_stated", floor.nominal);
    json.close();
    add_cells(json, static_cast<double>(trial.records[0].truth.size()) * kSampleTime);
  }
  json.close();
  return json.text();
}

}  // namespace trial
