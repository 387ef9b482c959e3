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

std::filesystem::path specimen_file(const Config& file) {
  return find_file(file.table_or_empty("specimen"), "model", "bearings", kDefaultSpecimen);
}

}  // namespace

Config read_bearing_with(const Config& changes) {
  const Config bearing = Config::load(find_file(changes, "model", "bearings", kDefaultSpecimen));
  check_units(changes, bearing);
  return bearing.overlaid(changes);
}

Config read_specimen(const Config& file) {
  return read_bearing_with(file.table_or_empty("specimen"));
}

void read_laboratory(const Config& file, const std::string& improvement, Experiment& experiment) {
  const auto path = specimen_file(file);
  const Config specimen = read_specimen(file);
  const Config assumed_changes = file.table_or_empty("model").table_or_empty("specimen");
  if (!assumed_changes.has("model")) check_units(assumed_changes, specimen);
  static_cast<void>(specimen.text("model", ""));
  const double weight = experiment.plant.structure->weight();
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

namespace {

// One number for both axes, or [long, lat].
void read_pair(const Config& table, const std::string& key, double sim::ServoAxis::*member,
               std::array<sim::ServoAxis, sim::kHorizontalAxes>& axes) {
  if (!table.has(key)) return;
  const auto values = table.numbers(key);
  if (values.size() != axes.size())
    table.fail(key,
               key + " has " + std::to_string(values.size()) + " numbers, expected [long, lat]");
  for (std::size_t i = 0; i < axes.size(); ++i) axes[i].*member = values[i];
}

}  // namespace

std::span<const MachineKey> machine_keys() {
  static constexpr MachineKey kKeys[] = {{"position_gain_per_s", &sim::ServoAxis::position_gain},
                                         {"pressure_gain", &sim::ServoAxis::pressure_gain},
                                         {"pressure_washout_Hz", &sim::ServoAxis::pressure_washout},
                                         {"valve_frequency_Hz", &sim::ServoAxis::valve_frequency},
                                         {"valve_damping", &sim::ServoAxis::valve_damping},
                                         {"dead_band", &sim::ServoAxis::dead_band},
                                         {"rated_flow_m3_per_s", &sim::ServoAxis::rated_flow},
                                         {"piston_area_m2", &sim::ServoAxis::piston_area},
                                         {"oil_volume_m3", &sim::ServoAxis::oil_volume},
                                         {"bulk_modulus_Pa", &sim::ServoAxis::bulk_modulus},
                                         {"leakage_m3_per_Pa_s", &sim::ServoAxis::leakage},
                                         {"transport_delay_s", &sim::ServoAxis::transport_delay},
                                         {"effective_mass_kg", &sim::ServoAxis::effective_mass},
                                         {"force_offset_N", &sim::ServoAxis::force_offset}};
  return kKeys;
}

sim::TestMachine read_machine(const Config& changes) {
  const Config table = sim::srmd_terms().overlaid(changes);
  sim::TestMachine machine = sim::srmd_machine();
  auto& axes = machine.axes;
  for (const auto& [key, member] : machine_keys()) read_pair(table, key, member, axes);
  auto& noise = machine.noise;
  noise.displacement = table.number_in("displacement_noise_m", 0, 1, noise.displacement);
  noise.force = table.number_in("force_noise_N", 0, 1e9, noise.force);
  noise.acceleration = table.number_in("acceleration_noise_m_per_s2", 0, 1e3, noise.acceleration);
  machine.has_specimen = !table.flag("empty_table", false);
  machine.has_rollers = table.flag("rollers", false);
  if (machine.has_rollers && machine.has_specimen)
    table.fail(
        "rollers",
        "rollers is true, but empty_table is false: a table carries either rollers or a specimen");
  machine.terms = sim::read_terms(table, sim::TermOwner::Machine);
  table.reject_unknown_keys();
  return machine;
}

}  // namespace rths::experiment
