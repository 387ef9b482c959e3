// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace rths::experiment {
namespace {

constexpr double kPartOfTick = 1e-6;  // rounding of a step

using Kinds = std::span<const AdapterKind>;

const AdapterKind& kind_named(Kinds kinds, const Config& table) {
  const std::string name = table.text("adapter");
  std::string known;
  for (const auto& kind : kinds) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + std::string{kind.name};
  }
  table.fail("adapter", fmt::format("there is no adapter '{}', expected one of {}", name, known));
}

// Reads parameters written with dots (ats.enabled = 0) or in tables ([… ats]).
void read_tuning(const Config& table, const std::string& prefix, Tuning& tuning) {
  for (const auto& key : table.keys()) {
    if (table.is_table(key))
      read_tuning(table.table(key), prefix + key + ".", tuning);
    else
      tuning.emplace_back(prefix + key, table.number(key));
  }
}

NodePlan read_node(Kinds kinds, const std::string& node, const Config& table,
                   const Experiment& experiment) {
  const AdapterKind& kind = kind_named(kinds, table);
  NodePlan plan;
  plan.node = node;
  plan.adapter = kind.name;
  plan.table = table;
  plan.host = table.text("host", "");
  plan.settings = kind.read(node, table, experiment);
  const auto& usual = plan.settings.schedule;
  plan.schedule.missed = usual.missed;
  plan.schedule.period =
      from_seconds(table.number_in("period_s", 1e-5, 1, to_seconds(usual.period)));
  plan.schedule.phase = from_seconds(table.number_in("phase_s", 0, 1, to_seconds(usual.phase)));
  read_tuning(table.table_or_empty("tune"), "", plan.tune);
  table.reject_unknown_keys();
  return plan;
}

}  // namespace

std::vector<NodePlan> read_nodes(Kinds kinds, const Config& table, const Experiment& experiment) {
  std::vector<NodePlan> nodes;
  for (const auto& node : table.keys())
    nodes.push_back(read_node(kinds, node, table.table(node), experiment));
  // Receivers start before senders.
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const auto& a, const auto& b) { return a.settings.role < b.settings.role; });
  return nodes;
}

void check_handshake(const Config& file, const Experiment& experiment) {
  const double step = experiment.time.simulation_step();
  for (const auto& controller : experiment.nodes) {
    if (controller.settings.role != Role::Controller) continue;
    const double tick = to_seconds(controller.schedule.period);
    for (const auto& solver : experiment.nodes)
      if (step < (solver.settings.solver.ticks_per_target - kPartOfTick) * tick)
        file.fail("integration_step_s",
                  fmt::format("a step takes {:g} s, and node '{}' reads the flags every {:g} s: "
                              "expected two ticks for a target, or handshake = \"numbered\" of "
                              "node '{}'",
                              step, controller.node, tick, solver.node));
  }
}

MissedSteps read_late_inputs(const Config& table, const char* otherwise, MissedSteps due) {
  const std::string inputs = table.text("late_inputs", otherwise);
  if (inputs != "due" && inputs != "newest")
    table.fail("late_inputs", fmt::format("late_inputs is '{}', expected due or newest", inputs));
  return inputs == "due" ? due : MissedSteps::Make;
}

void read_uncompensated(const Config& table, std::vector<NodePlan>& nodes) {
  for (const auto& node : table.keys()) {
    const auto plan = std::find_if(nodes.begin(), nodes.end(),
                                   [&](const auto& candidate) { return candidate.node == node; });
    if (plan == nodes.end())
      table.fail(
          node,
          fmt::format("[uncompensated] names node '{}', expected a node of the experiment", node));
    read_tuning(table.table(node), "", plan->uncompensated);
  }
}

void settle_missed_steps(Experiment& experiment) {
  const Schedule* first = nullptr;
  bool all_wait = !experiment.cards.has_value();
  const auto is_part = [](const NodePlan& plan) {
    return plan.settings.role == Role::Machine || plan.settings.role == Role::Controller ||
           plan.schedule.missed == MissedSteps::Wait;
  };
  for (const auto& plan : experiment.nodes) {
    if (!is_part(plan)) continue;
    if (first == nullptr) first = &plan.schedule;
    all_wait = all_wait && plan.schedule.missed == MissedSteps::Wait &&
               plan.schedule.period == first->period && plan.host == experiment.nodes[0].host;
  }
  for (auto& plan : experiment.nodes)
    if (!all_wait && plan.schedule.missed == MissedSteps::Wait)
      plan.schedule.missed = MissedSteps::MakeDue;
}

}  // namespace rths::experiment
