// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/block_settings.hpp>
#include <rths/adapters/simulink_like.hpp>
#include <rths/core/file.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::adapters {

using namespace experiment;

namespace {

constexpr double kPhase = 0.3e-3;  // after the machine has sampled [s]

std::map<std::string, std::string> units_of(const memmap::Map& map) {
  std::map<std::string, std::string> units;
  for (const auto& entry : map.signals()) units[entry.name] = entry.signal->unit;
  return units;
}

}  // namespace

NodeSettings read_simulink_like(const std::string& /*node*/, const Config& table,
                                const Experiment& /*setup*/) {
  NodeSettings settings;
  settings.role = Role::Controller;
  const auto choice = read_diagram_choice(table);
  settings.schedule = schedule_of(diagram_period(choice.diagram), kPhase, MissedSteps::Wait);
  settings.priority = 50;
  settings.keeps_times = true;
  settings.texts = [choice] {
    std::vector<std::pair<std::string, std::string>> texts;
    for (const auto& used : {choice.diagram, choice.constants})
      if (!used.empty())
        texts.emplace_back(used.filename().string(), read_file(used, kMostTextBytes));
    return texts;
  };
  settings.make = [choice](const Experiment& test, const NodeContext& context) {
    return make_simulink_like(
        choice.diagram,
        {test.axes, test.time.integration_step, test.time.simulation_step(), test.stop.retreat,
         units_of(context.map), std::make_shared<const sim::Bearing>(test.model.bearing),
         choice.constants, choice.blocks});
  };
  return settings;
}

}  // namespace rths::adapters
