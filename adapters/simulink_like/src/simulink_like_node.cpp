// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/simulink_like_node.hpp>

#include <rths/adapters/simulink_like.hpp>
#include <rths/core/file.hpp>
#include <rths/core/installed_files.hpp>

namespace rths::adapters {

using experiment::NodeContext;
using experiment::NodeSettings;
using experiment::Role;
using experiment::TestSetup;

namespace {

constexpr double kPhase = 0.3e-3;  // after the machine has sampled [s]

std::map<std::string, std::string> units_of(const memmap::Map& map) {
  std::map<std::string, std::string> units;
  for (const auto& entry : map.signals()) units[entry.name] = entry.signal->unit;
  return units;
}

}  // namespace

NodeSettings read_simulink_like(const std::string& /*node*/, const Config& table,
                                const TestSetup& /*setup*/) {
  NodeSettings settings;
  settings.role = Role::Controller;
  settings.diagram = find_file(table, "diagram", "diagrams");
  if (table.has("constants")) settings.constants = table.resolve(table.text("constants"));
  settings.blocks = table.table_or_empty("blocks");
  settings.schedule = schedule_of(diagram_period(settings.diagram), kPhase, MissedSteps::Wait);
  settings.priority = 50;
  settings.keeps_times = true;
  settings.texts = [diagram = settings.diagram, constants = settings.constants] {
    std::vector<std::pair<std::string, std::string>> texts;
    for (const auto& used : {diagram, constants})
      if (!used.empty())
        texts.emplace_back(used.filename().string(), read_file(used, kMostTextBytes));
    return texts;
  };
  settings.make = [diagram = settings.diagram, constants = settings.constants,
                   blocks = settings.blocks](const TestSetup& test, const NodeContext& context) {
    return make_simulink_like(
        diagram, {test.axes, test.integration_step, test.simulation_step(), test.retreat,
                  units_of(context.map), std::make_shared<const sim::Bearing>(test.model),
                  constants, blocks});
  };
  return settings;
}

}  // namespace rths::adapters
