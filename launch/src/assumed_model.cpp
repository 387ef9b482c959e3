// SPDX-License-Identifier: Apache-2.0
#include "assumed_model.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <rths/adapters/test_setup.hpp>
#include <rths/core/contains.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/launch/hybrid_test.hpp>
#include <rths/sim/composition.hpp>

namespace rths::launch {
namespace {

bool is_enabled(const Config& term) { return term.flag("enabled", true); }

constexpr std::string_view kMachinePrefix = "machine_";

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

// Terms of a diagnosis for "specimen" or "machine". Added terms are enabled even if the model
// disables them.
Config found_in(const Config& improvement, const char* side) {
  Config terms = improvement.table_or_empty(side);
  for (const auto& name : terms.keys()) {
    if (!terms.is_table(name)) continue;
    Config term = terms.table(name);
    if (term.has("kind") && !term.has("enabled")) term.set("enabled", "true");
    terms.set(name, term);
  }
  return terms;
}

// A parameter of the machine that is a term of the model. `parameter` has one number for both axes,
// or [long, lat].
struct AxisTerm {
  const char* term;
  const char* parameter;
  const char* key;  ///< of the machine
};
constexpr AxisTerm kAxisTerms[] = {{"platen_inertia", "mass_kg", "effective_mass_kg"},
                                   {"force_offset", "offset_N", "force_offset_N"}};

const AxisTerm* axis_term(const std::string& name) {
  const auto known = std::find_if(std::begin(kAxisTerms), std::end(kAxisTerms),
                                  [&](const AxisTerm& one) { return one.term == name; });
  return known == std::end(kAxisTerms) ? nullptr : known;
}

std::vector<double> of_both_axes(const Config& term, const std::string& parameter) {
  if (!term.is_array(parameter))
    return std::vector<double>(sim::kHorizontalAxes, term.number(parameter));
  const auto values = term.numbers(parameter);
  if (values.size() != sim::kHorizontalAxes)
    term.fail(parameter,
              fmt::format("{} has {} numbers, expected [long, lat]", parameter, values.size()));
  return values;
}

// Converts refitted terms of the machine from names of the model. There, inertia and force offset
// are terms, and terms whose names the specimen uses have a prefix.
Config as_machine(const Config& found) {
  Config machine = found;
  for (const auto& name : found.keys()) {
    if (!found.is_table(name) || found.table(name).has("kind")) continue;
    const Config term = found.table(name);
    const AxisTerm* of_axes = axis_term(name);
    const bool is_renamed = name.starts_with(kMachinePrefix);
    if (of_axes == nullptr && !is_renamed) continue;
    machine = machine.without(name);
    if (of_axes != nullptr)
      machine.put(of_axes->key, of_both_axes(term, of_axes->parameter));
    else
      machine.set(name.substr(kMachinePrefix.size()), term);
  }
  return machine;
}

// Overlays the improved.toml files of `improvement`; later files override earlier ones.
Config read_improvement(const Config& table) {
  Config improvement;
  for (const auto& file : table.texts("improvement", {})) {
    const Config found = Config::load(table.resolve(file));
    const Config terms = Config{}
                             .overlaid(found.table_or_empty("specimen"))
                             .overlaid(found.table_or_empty("machine"));
    if (terms.keys().empty())
      throw Error{
          fmt::format("{}: found no term, expected a term in [specimen] or [machine]", file)};
    found.reject_unknown_keys();
    improvement = improvement.overlaid(found);
  }
  return improvement;
}

// Another bearing if `model` is given, otherwise the specimen with changes.
Config bearing_of(const Config& changes, const Config& specimen) {
  if (!changes.has("model")) return specimen.overlaid(changes);
  const Config other = Config::load(find_file(changes, "model", "bearings"));
  return other.overlaid(changes);
}

// The actuator terms of a machine, switched off: the identified transfer system contains them.
Config without_actuator_terms(Config machine) {
  for (const auto& name : machine.keys()) {
    if (!machine.is_table(name)) continue;
    Config term = machine.table(name);
    if (sim::term_kind(term.text("kind", name)).stage != sim::Stage::Actuator) continue;
    term.set("enabled", "false");
    machine.set(name, term);
  }
  return machine;
}

// The hydraulics of each axis as identified.
void put_hydraulics(const budget::MismatchBudget& found, Config& machine) {
  auto axes = adapters::read_machine(machine).axes;
  for (const auto& axis : found.axes) {
    auto& one = axes[axis.name == "long" ? 0 : 1];
    one = budget::servo_axis(axis.transfer, one);
  }
  for (const auto& [key, member] : adapters::machine_keys())
    machine.put(key, std::vector<double>{axes[0].*member, axes[1].*member});
}

// The machine of a node is that of [machine], with the identified hydraulics, not one of a file.
Config with_identified_machine(Config nodes) {
  for (const auto& name : nodes.keys()) {
    Config node = nodes.table(name);
    if (node.text("adapter", "") != "srmd") continue;
    for (const char* key : {"model", "family_member", "changes"}) node = node.without(key);
    nodes.set(name, node);
  }
  return nodes;
}

}  // namespace

Config improved_experiment(const Config& experiment, const std::string& improvement,
                           const budget::MismatchBudget& found) {
  const Config model = experiment.table_or_empty("model");
  const Config terms =
      read_improvement(model).overlaid(Config::parse(improvement, "improved.toml"));
  const Config changes = model.table_or_empty("specimen").overlaid(found_in(terms, "specimen"));
  Config machine = without_actuator_terms(experiment.table_or_empty("machine")
                                              .overlaid(model.table_or_empty("machine"))
                                              .overlaid(as_machine(found_in(terms, "machine"))));
  put_hydraulics(found, machine);
  Config improved = experiment;
  improved.put("name", experiment.text("name") + "_improved");
  improved.set("specimen", changes.has("model")
                               ? changes
                               : experiment.table_or_empty("specimen").overlaid(changes));
  improved.set("machine", machine);
  improved.set("node", with_identified_machine(experiment.table_or_empty("node")));
  improved.set("model", model.without("specimen").without("machine").without("improvement"));
  return improved;
}

AssumedModel read_assumed_model(const Config& table, const Config& specimen, const Config& machine,
                                double axial_load) {
  const Config improvement = read_improvement(table);
  const Config bearing = bearing_of(
      table.table_or_empty("specimen").overlaid(found_in(improvement, "specimen")), specimen);
  static_cast<void>(bearing.text("model", ""));
  AssumedModel assumed{sim::read_bearing(bearing, axial_load), {}, "", ""};

  const Config changed = machine.overlaid(table.table_or_empty("machine"))
                             .overlaid(as_machine(found_in(improvement, "machine")));
  assumed.machine = adapters::read_machine(changed);
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

}  // namespace rths::launch
