// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <vector>

#include <fmt/format.h>

#include <rths/core/installed_files.hpp>
#include <rths/core/text.hpp>
#include <rths/experiment/improvement.hpp>
#include <rths/experiment/machine_table.hpp>
#include <rths/sim/composition.hpp>

namespace rths::experiment {
namespace {

bool is_enabled(const Config& term) { return term.flag("enabled", true); }

// Specimen and machine can have terms of the same name; a model holds both.
std::string free_name(const Config& model, const std::string& name) {
  return model.has(name) ? std::string{kMachinePrefix} + name : name;
}

void add_terms(Config& model, const Config& terms) {
  for (const auto& key : terms.keys()) {
    if (!terms.is_table(key)) continue;
    Config term = terms.table(key);
    if (!is_enabled(term)) continue;
    const std::string name = free_name(model, key);
    if (!term.has("kind") && name != key) term.set("kind", fmt::format("\"{}\"", key));
    model.set(name, term);
  }
}

// Inertia and force offset are parameters of the machine; in a model they are terms.
void add_axes(Config& model, const sim::TestMachine& machine) {
  const auto add = [&](const std::string& wanted, const std::string& head, const char* key,
                       double sim::ServoAxis::*member) {
    model.set(free_name(model, wanted),
              Config::parse(fmt::format("{}\n{} = [{}, {}]", head, key, machine.axes[0].*member,
                                        machine.axes[1].*member),
                            "[machine]"));
  };
  add("platen_inertia", "kind = \"platen_inertia\"", "mass_kg", &sim::ServoAxis::effective_mass);
  add("force_offset", "kind = \"offset\"\nchannel = \"force\"", "offset_N",
      &sim::ServoAxis::force_offset);
}

// Requires that the model has each "term.parameter"; a fit would silently omit a wrong name.
void check_composition(const Config& table, const Config& model, const std::string& bearing) {
  std::vector<std::string> known;
  for (const auto& key : model.keys()) {
    if (!model.is_table(key)) continue;
    for (const auto& parameter : sim::term_kind(model.table(key).text("kind", key)).parameters)
      known.push_back(fmt::format("{}.{}", key, parameter.name));
  }
  for (const auto& name : table.texts("fitted", {})) {
    if (contains(known, name)) continue;
    const std::string hint = did_you_mean(name, known);
    table.fail(
        "fitted",
        fmt::format("the model has no parameter '{}'{}", name,
                    hint.empty() ? fmt::format(", expected \"term.parameter\" of the "
                                               "specimen '{}' or of the machine; fitted = [] "
                                               "fits none",
                                               bearing)
                                 : hint));
  }
}

// Another bearing if `model` is given, otherwise the specimen with changes.
Config bearing_of(const Config& changes, const Config& specimen) {
  if (!changes.has("model")) return specimen.overlaid(changes);
  const Config other = Config::load(find_file(changes, "model", "bearings"));
  return other.overlaid(changes);
}

}  // namespace

AssumedModel read_assumed_model(const Config& table, const Improvement& found,
                                const Config& specimen, const Config& machine, double axial_load) {
  const Config bearing =
      bearing_of(table.table_or_empty("specimen").overlaid(found.specimen), specimen);
  static_cast<void>(bearing.text("model", ""));
  AssumedModel assumed{sim::read_bearing(bearing, axial_load), {}, "", ""};

  const Config changed = machine.overlaid(table.table_or_empty("machine")).overlaid(found.machine);
  assumed.machine = read_machine(changed);
  Config model;
  model.set("kind", "\"platen\"");
  if (bearing.has("temperature_above_reference_K"))
    model.set("temperature_above_reference_K", fmt::format("{}", assumed.bearing.temperature));
  if (assumed.machine.has_specimen) {
    add_terms(model, bearing);
    assumed.specimen = bearing.without("model").to_toml();
  }
  add_terms(model, sim::srmd_terms().overlaid(changed));
  add_axes(model, assumed.machine);
  check_composition(table, model, assumed.bearing.title);
  model.put("fitted", table.texts("fitted", {}));
  if (table.has("bounds")) model.set("bounds", table.table("bounds"));
  table.reject_unknown_keys();
  assumed.text = model.to_toml();
  return assumed;
}

}  // namespace rths::experiment
