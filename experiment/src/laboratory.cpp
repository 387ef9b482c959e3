// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <rths/core/file.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/experiment/machine_table.hpp>

namespace rths::experiment {
namespace {

constexpr const char* kDefaultSpecimen = "lprb";

// Its friction may be small, and is fitted.
Config usual_machine() {
  Config usual;
  const auto axes = sim::srmd_machine().axes;
  for (const auto& [key, member] : machine_keys())
    usual.put(key, std::vector<double>{axes[0].*member, axes[1].*member});
  return usual;
}

}  // namespace

void read_laboratory(const Config& file, const std::string& improvement, Experiment& experiment) {
  const Config changes = file.table_or_empty("specimen");
  const auto path = find_file(changes, "model", "bearings", kDefaultSpecimen);
  const Config bearing = Config::load(path);
  const Config specimen = bearing.overlaid(changes);
  check_units(changes, bearing);
  const Config assumed_changes = file.table_or_empty("model").table_or_empty("specimen");
  if (!assumed_changes.has("model")) check_units(assumed_changes, specimen);
  static_cast<void>(specimen.text("model", ""));
  const double weight = sim::weight_per_bearing(experiment.plant.structure);
  experiment.specimen = sim::read_bearing(specimen, weight);
  experiment.config.emplace_back(path.filename().string(), read_file(path, kMostTextBytes));
  const Config machine = file.table_or_empty("machine");
  check_units(machine, usual_machine());
  auto& simulated = experiment.machine.simulated;
  simulated = read_machine(machine);
  simulated.seed = experiment.seed;
  simulated.specimen = experiment.specimen;
  const Config model = file.table_or_empty("model");
  experiment.model =
      read_assumed_model(model, read_improvement(model, improvement), specimen, machine, weight);
  experiment.config.emplace_back(recording::kModelText, experiment.model.text);
  if (!experiment.model.specimen.empty())
    experiment.config.emplace_back(recording::kSpecimenText, experiment.model.specimen);
}

}  // namespace rths::experiment
