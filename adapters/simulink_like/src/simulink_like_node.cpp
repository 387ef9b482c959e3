// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/simulink_like_node.hpp>

#include <rths/adapters/simulink_like.hpp>
#include <rths/adapters/specimen_sliders.hpp>
#include <rths/core/file.hpp>
#include <rths/core/installed_files.hpp>

namespace rths::adapters {
namespace {

constexpr double kPhase = 0.3e-3;  // after the machine has sampled [s]

std::map<std::string, std::string> units_of(const memmap::Map& map) {
  std::map<std::string, std::string> units;
  for (const auto& entry : map.signals()) units[entry.name] = entry.signal->unit;
  return units;
}

// The sliders of a `target_force` are those of the assumed specimen, if nothing states them.
Config with_sliders(const NodeSettings& settings, const sim::Bearing& model) {
  Config changes = settings.blocks;
  for (const Config& block :
       blocks_of(Config::load(settings.diagram), settings.constants, settings.blocks)) {
    const auto is_stated = [&](const char* key) { return block.has(key); };
    if (block.text("type", "") != "target_force" || is_stated("reach_m") ||
        is_stated("smooth_reach_m") || is_stated("expected_strengths_N"))
      continue;
    const SpecimenSliders sliders = sliders_of(model);
    const std::string name = block.text("name");
    Config change = changes.table_or_empty(name);
    change.put("reach_m", sliders.sharp);
    change.put("smooth_reach_m", sliders.smooth);
    change.put("expected_strengths_N", sliders.strengths);
    changes.set(name, change);
  }
  return changes;
}

}  // namespace

NodeSettings read_simulink_like(const std::string& /*node*/, const Config& table,
                                const TestSetup& setup) {
  NodeSettings settings;
  settings.role = Role::Controller;
  settings.diagram = find_file(table, "diagram", "diagrams");
  if (table.has("constants")) settings.constants = table.resolve(table.text("constants"));
  settings.blocks = table.table_or_empty("blocks");
  settings.blocks = with_sliders(settings, setup.model);
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
    return make_simulink_like(diagram, {test.axes, test.integration_step, test.simulation_step(),
                                        test.retreat, units_of(context.map), constants, blocks});
  };
  return settings;
}

}  // namespace rths::adapters
