// SPDX-License-Identifier: Apache-2.0
#include <rths/session/hybrid_test.hpp>

#include <string>
#include <vector>

#include <rths/core/axis.hpp>
#include <rths/core/config.hpp>
#include <rths/experiment/improvement.hpp>
#include <rths/experiment/machine_table.hpp>

namespace rths::session {
namespace {

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
  auto axes = experiment::read_machine(machine).axes;
  for (const auto& axis : found.axes) {
    auto& one = axes[index_of(axis.axis)];
    one = sim::servo_axis(axis.transfer, one);
  }
  for (const auto& [key, member] : experiment::machine_keys())
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
  const experiment::Improvement terms = experiment::read_improvement(model, improvement);
  const Config changes = model.table_or_empty("specimen").overlaid(terms.specimen);
  Config machine = without_actuator_terms(experiment.table_or_empty("machine")
                                              .overlaid(model.table_or_empty("machine"))
                                              .overlaid(terms.machine));
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

}  // namespace rths::session
