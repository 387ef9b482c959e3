// SPDX-License-Identifier: Apache-2.0
//
// Facts of a run in words, from the experiment in its recording.
#include <map>
#include <optional>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/config.hpp>
#include <rths/core/text.hpp>
#include <rths/recording/roles.hpp>
#include <rths/report/report.hpp>
#include <rths/sim/isolated_plant.hpp>

#include "analysis.hpp"

namespace rths::report {
namespace {

constexpr const char* kCompleted = "completed";
constexpr const char* kNoEnding =
    "no ending was recorded: the launcher was killed, or the run has not ended";

// A word of a shell command, quoted where it has to be.
std::string quoted(const std::string& word) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=+,:-";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string{"'\\''"} : std::string{c};
  return text + "'";
}

std::string text_at(const std::map<std::string, std::string>& meta, const std::string& key,
                    const std::string& otherwise) {
  const auto found = meta.find(key);
  return found == meta.end() ? otherwise : found->second;
}

std::string command_of(const std::map<std::string, std::string>& meta,
                       const std::vector<std::string>& overrides) {
  std::string command =
      "rths run " + quoted(text_at(meta, "experiment_path", text_at(meta, "experiment", "")));
  for (const auto& change : overrides) command += " --set " + quoted(change);
  return command + (text_at(meta, "clock", "") == "virtual" ? " --clock virtual" : "");
}

// Names of the tables inside a table; disabled terms are marked.
std::vector<std::string> terms_in(const Config& table, const std::string& prefix) {
  std::vector<std::string> names;
  for (const auto& name : table.keys())
    if (table.is_table(name))
      names.push_back(prefix + name + (table.table(name).flag("enabled", true) ? "" : " (off)"));
  return names;
}

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (const auto& item : items) text += (text.empty() ? "" : ", ") + item;
  return text;
}

// The first node with one of the adapters; an empty table if there is none.
Config table_of_node(const Config& file, const std::vector<std::string>& adapters) {
  const Config nodes = file.table_or_empty("node");
  const auto name = recording::node_with(nodes, adapters);
  return name ? nodes.table(*name) : Config{};
}

const std::vector<std::string>& models_of_machines() {
  static const std::vector<std::string> adapters{"srmd", "ideal_machine", "echo",
                                                 "opensees_specimen"};
  return adapters;
}

// Adapters of the user's own.
const std::vector<std::string>& own_adapters() {
  static const std::vector<std::string> adapters{"external", "plugin", "fmu"};
  return adapters;
}

/// The node that plays specimen and machine. Empty: no node of the experiment does.
struct MachineNode {
  std::string name, adapter;
};

// An ideal machine, and some machines of users, play the controller too. Their experiment has no
// node with the role.
MachineNode machine_in(const Config& file, const Roles& roles) {
  const Config nodes = file.table_or_empty("node");
  if (nodes.is_table(roles.machine))
    return {roles.machine, nodes.table(roles.machine).text("adapter", "")};
  for (const auto* adapters : {&models_of_machines(), &own_adapters()})
    for (const auto& name : nodes.keys()) {
      const std::string adapter = nodes.table(name).text("adapter", "");
      if (name != roles.solver && contains(*adapters, adapter)) return {name, adapter};
    }
  return {};
}

// Names of the nodes that are programs of the user's own.
std::vector<std::string> foreign_nodes(const Config& file) {
  std::vector<std::string> names;
  const Config nodes = file.table_or_empty("node");
  for (const auto& name : nodes.keys())
    if (nodes.table(name).text("adapter", "") == "external") names.push_back(name);
  return names;
}

std::string laboratory_sentence(const Config& file, const MachineNode& machine) {
  if (machine.name.empty()) return "Specimen and machine are not nodes of this experiment.";
  if (!contains(models_of_machines(), machine.adapter))
    return fmt::format(
        "Node {} with adapter {} represents specimen and machine. It is the user's own and may "
        "drive a real machine.",
        machine.name, machine.adapter);
  const std::string bearing = file.table_or_empty("specimen").text("model", "lprb");
  if (machine.adapter == "srmd")
    return fmt::format(
        "Specimen ({}) and test machine are models in software. No value was measured in a "
        "laboratory.",
        bearing);
  return fmt::format(
      "The node with adapter {} represents specimen and machine. No value was measured in a "
      "laboratory.",
      machine.adapter);
}

std::string structure_sentence(const Config& file) {
  const Config solver = table_of_node(file, {"numerical", "opensees"});
  if (file.has("reference"))
    return fmt::format(
        "The structure is that of the solver. The numerical result is {}, the user's own.",
        file.table("reference").text("file", ""));
  if (!solver.has("adapter") || (solver.text("adapter", "") == "opensees" && !solver.has("script")))
    return file.has("plant")
               ? "The structure is that of the solver's program. The numerical result is that of "
                 "the experiment's [plant]: compare them only if both describe the same structure."
               : "The structure is that of the solver's program.";
  if (solver.text("adapter", "") == "opensees")
    return fmt::format(
        "The structure is that of {0}. The numerical result is that of {0} with an ideal machine "
        "and "
        "the model in place of the specimen.",
        solver.text("script", ""));
  const Config plant = file.table_or_empty("plant");
  return fmt::format("Masses and frequencies of the structure are {}.",
                     plant.has("basemat_mass_kg") || plant.has("stick")
                         ? "those of the experiment's [plant]"
                         : "assumptions of this project");
}

bool is_large(const Config& plant) { return plant.text("model", "sticks") != "sticks"; }

std::string vertical_sentence(const Config& file, const MachineNode& machine) {
  if (table_of_node(file, {"numerical"}).text("vertical_feedback", "model") == "measured")
    return "The vertical force is tested, too: its measurement restores the structure.";
  const Config motion = file.table_or_empty("motion"), plant = file.table_or_empty("plant");
  std::vector<std::string> causes;
  if (motion.has("column_vert") || motion.has("file_vert"))
    causes.emplace_back("vertical motion of the ground");
  if (plant.number("bearing_long_m", 0) != 0 || plant.number("bearing_lat_m", 0) != 0)
    causes.emplace_back("overturning of the structure");
  // On one bearing, it cannot overturn.
  if (is_large(plant) && plant.integer("bearings", 0) != 1)
    causes.emplace_back("overturning and bending of the structure");
  if (causes.empty() || table_of_node(file, {"opensees"}).has("adapter"))
    return "The vertical load of the bearing is constant.";
  if (machine.adapter == "ideal_machine")
    return "The ideal machine has no vertical axis, so the vertical load of the bearing is "
           "constant.";
  return fmt::format("The vertical load of the bearing varies by {}.",
                     fmt::join(causes, " and by "));
}

std::vector<std::string> scope_of(const Config& file, const MachineNode& machine) {
  std::vector<std::string> scope{laboratory_sentence(file, machine)};
  if (const auto foreign = foreign_nodes(file); !foreign.empty())
    scope.push_back(
        fmt::format("{} of the user's own: {}.",
                    foreign.size() == 1 ? "This node is a program" : "These nodes are programs",
                    list_of(foreign)));
  auto changed = terms_in(file.table_or_empty("specimen"), "specimen.");
  for (auto& name : terms_in(file.table_or_empty("machine"), "machine."))
    changed.push_back(std::move(name));
  if (!changed.empty())
    scope.push_back("The experiment sets these terms of specimen and machine: " + list_of(changed) +
                    ".");
  const Config model = file.table_or_empty("model");
  auto differences = terms_in(model.table_or_empty("specimen"), "specimen.");
  for (auto& name : terms_in(model.table_or_empty("machine"), "machine."))
    differences.push_back(std::move(name));
  if (!differences.empty())
    scope.push_back("The model of the simulation differs in: " + list_of(differences) + ".");
  scope.push_back(structure_sentence(file));
  const auto axes = file.texts("axes", names_of(kHorizontal));
  scope.push_back(fmt::format("Tested {}: {}. The rotations' commands are zero. {}",
                              axes.size() == 1 ? "axis" : "axes", list_of(axes),
                              vertical_sentence(file, machine)));
  return scope;
}

// Without an earthquake, the run imposes the displacements of [targets].
std::string motion_name(const Config& file) {
  if (!file.has("motion")) return "commanded displacements";
  const Config motion = file.table("motion");
  const std::string name = motion.text("name", motion.text("file", ""));
  const double scale = motion.number("scale", 1.0);
  return scale == 1 ? name : name + fmt::format(" × {:g}", scale);
}

}  // namespace

std::optional<bool> is_of_models(const Reader& run) {
  const auto experiment = recording::experiment_in(run);
  if (!experiment) return std::nullopt;
  return contains(models_of_machines(), machine_in(*experiment, recording::roles_of(run)).adapter);
}

RunDescription describe(const Reader& run) {
  RunDescription test;
  test.meta = run.meta();
  test.clock = test.meta["clock"];
  const std::string ending = text_at(test.meta, "ending", kNoEnding);
  test.ending = ending == kCompleted ? "" : ending;
  const auto experiment = recording::experiment_in(run);
  if (!experiment) return test;
  const Config& file = *experiment;
  test.command = command_of(test.meta, lines(run.config(recording::kOverridesText)));
  test.name = file.text("name");
  test.integration_step = file.number("integration_step_s", 0.01);
  test.rate = file.number("rate", 1);
  test.planned_duration = file.number("duration_s", 0);
  const Config plant = file.table_or_empty("plant");
  if (!is_large(plant) && !table_of_node(file, {"opensees"}).has("floor"))
    test.spectrum_elevation =
        plant.number("spectrum_elevation_m", sim::IsolatedPlant{}.spectrum_elevation);
  test.rest = file.number("rest_s", 0);
  test.motion = motion_name(file);
  const Config bounds = file.table_or_empty("conclusive");
  for (const auto& key : bounds.keys()) test.stated_bounds[key] = bounds.number(key);
  const MachineNode machine = machine_in(file, recording::roles_of(run));
  test.synthetic = contains(models_of_machines(), machine.adapter);
  test.scope = scope_of(file, machine);
  if (const auto node = text_at(test.meta, "without_safety_layer", ""); !node.empty())
    test.scope.push_back(
        fmt::format("Node {} has no safety layer: rths does not guard its commands.", node));
  return test;
}

}  // namespace rths::report
