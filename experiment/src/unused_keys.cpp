// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/axis.hpp>
#include <rths/core/text.hpp>

namespace rths::experiment {
namespace {

[[noreturn]] void fail_unused(const Config& table, const std::string& name, const std::string& key,
                              const std::string& reason) {
  table.fail(key, fmt::format("{}.{} has no effect: {}", name, key, reason));
}

/// The node that makes the most of [machine].
const NodePlan* machine_of(const Experiment& experiment) {
  const auto most = std::max_element(experiment.nodes.begin(), experiment.nodes.end(),
                                     [](const auto& a, const auto& b) {
                                       return a.settings.machine_table < b.settings.machine_table;
                                     });
  return most == experiment.nodes.end() ? nullptr : &*most;
}

bool is_carriage(const std::string& key) { return key == "empty_table" || key == "rollers"; }

// A change of a term's table would change the assumed machine only, and a test would never show it.
void check_machine(const Config& file, Experiment& experiment) {
  const Config table = file.table_or_empty("machine");
  const NodePlan* node = machine_of(experiment);
  if (table.keys().empty() || node == nullptr) return;
  switch (node->settings.machine_table) {
    case MachineTable::Whole:
      return;
    case MachineTable::Model:
      experiment.remarks.push_back(fmt::format(
          "[machine] ({}) does not change the machine of node {}, only the model in the diagnosis",
          fmt::join(table.keys(), ", "), node->node));
      return;
    case MachineTable::Carriage:
      for (const auto& key : table.keys())
        if (!is_carriage(key))
          fail_unused(table, "machine", key,
                      fmt::format("the machine of node {} is that of its file, expected the key in "
                                  "[node.{}.changes], or in [model.machine] for the diagnosis",
                                  node->node, node->node));
      return;
    case MachineTable::Unused:
      fail_unused(table, "machine", table.keys()[0], "no node is a machine with these parameters");
  }
}

bool any_solver(const Experiment& experiment, bool SolverTraits::*property) {
  return std::any_of(experiment.nodes.begin(), experiment.nodes.end(),
                     [&](const auto& plan) { return plan.settings.solver.*property; });
}

void check_solver(const Config& file, const Experiment& experiment) {
  const Config table = file.table_or_empty("solver");
  const auto refuse = [&](std::initializer_list<const char*> keys, const char* reason) {
    for (const char* key : keys)
      if (table.has(key)) fail_unused(table, "solver", key, reason);
  };
  if (!any_solver(experiment, &SolverTraits::integrates_plant))
    refuse({"alpha", "substeps"}, "no node integrates the plant, expected adapter = \"numerical\"");
  if (!any_solver(experiment, &SolverTraits::waits_for_flags))
    refuse({"wait_deadline_s"}, "no node waits for flags of the handshake");
  if (!any_solver(experiment, &SolverTraits::has_computing_time))
    refuse({"model_computing_time", "computing_time_s", "computing_time_spread", "overrun_fraction",
            "overrun_s"},
           "the computing time of no node is modelled");
  if (experiment.solver.computing_time.overrun_fraction == 0)
    refuse({"overrun_s"}, "no step takes longer, expected overrun_fraction above 0 too");
}

void check_vertical(const Config& file, const Experiment& experiment) {
  const auto has_vertical = [](const sim::GroundMotion& motion) {
    return !motion.vert_acceleration.empty();
  };
  if (has_vertical(experiment.earthquake.motion) || experiment.plant.structure->overturns() ||
      (experiment.held_out && has_vertical(*experiment.held_out)))
    return;
  const Config table = file.table_or_empty("plant");
  for (const char* key : {"vertical_frequency_Hz", "vertical_damping_ratio"})
    if (table.has(key))
      fail_unused(table, "plant", key,
                  "the motion has no vertical component, expected column_vert or file_vert");
}

void check_network(const Config& file, const Experiment& experiment) {
  if (!experiment.network.hosts.empty()) return;
  const Config table = file.table_or_empty("network");
  for (const auto& key : table.keys())
    fail_unused(table, "network", key, "the test runs on one host, expected tables [host.…]");
}

bool is_random(const Experiment& experiment) {
  const bool has_random_time = any_solver(experiment, &SolverTraits::has_computing_time) &&
                               (experiment.solver.models_computing_time ||
                                any_solver(experiment, &SolverTraits::integrates_plant));
  const NodePlan* machine = machine_of(experiment);
  const bool has_noise =
      machine != nullptr && machine->settings.machine_table >= MachineTable::Carriage;
  return has_random_time || has_noise || experiment.history || experiment.cards;
}

void remark_seed(const Config& file, Experiment& experiment) {
  if (file.has("seed") && !is_random(experiment))
    experiment.remarks.emplace_back(
        "without an effect: seed (no noise, computing time or card of this test is simulated)");
}

// The same file serves tests along one axis and along both.
void remark_untested(const Config& file, Experiment& experiment) {
  std::vector<std::string> unused;
  for (const char* name : {"motion", "held_out"}) {
    const Config table = file.table_or_empty(name);
    for (const std::string& axis : names_of(kHorizontal)) {
      if (contains(experiment.axes, axis)) continue;
      if (table.has("column_" + axis)) unused.push_back(fmt::format("{}.column_{}", name, axis));
      if (table.has("file") && table.has("file_" + axis))
        unused.push_back(fmt::format("{}.file_{}", name, axis));
    }
  }
  if (!unused.empty())
    experiment.remarks.push_back(fmt::format("without an effect on a test along {}: {}",
                                             experiment.axes[0], fmt::join(unused, ", ")));
}

// Other runs of the same file need these tables, and `--set targets.kind=…` makes this one.
void remark_targets(const Config& file, Experiment& experiment) {
  if (!experiment.history) return;
  const bool is_response = file.table("targets").text("kind", "") == "response";
  std::vector<std::string> unused;
  for (const char* table : {"held_out", "conclusive", "uncompensated"})
    if (!file.table_or_empty(table).keys().empty()) unused.emplace_back(table);
  for (const char* table : {"motion", "plant"})
    if (!is_response && file.has(table)) unused.emplace_back(table);
  for (const char* key : {"alpha", "substeps"})
    if (file.table_or_empty("solver").has(key)) unused.push_back(fmt::format("solver.{}", key));
  if (!unused.empty())
    experiment.remarks.push_back(
        fmt::format("without an effect on commanded displacements: {}", fmt::join(unused, ", ")));
}

}  // namespace

void check_uses(const Config& file, Experiment& experiment) {
  check_machine(file, experiment);
  check_solver(file, experiment);
  if (!experiment.history) check_vertical(file, experiment);
  check_network(file, experiment);
  remark_seed(file, experiment);
  remark_untested(file, experiment);
  remark_targets(file, experiment);
}

}  // namespace rths::experiment
