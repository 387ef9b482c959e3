// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <utility>

namespace rths::experiment {
namespace {

sim::Stick read_stick(const Config& table) {
  sim::Stick stick;
  stick.name = table.text("name");
  stick.masses = table.numbers("masses_kg");
  stick.elevations = table.numbers("elevations_m");
  stick.frequency_long = table.number("frequency_long_Hz");
  stick.frequency_lat = table.number("frequency_lat_Hz");
  table.reject_unknown_keys();
  return stick;
}

}  // namespace

Plant read_plant(const Config& file) {
  const Config table = file.table_or_empty("plant");
  sim::IsolatedPlant plant = sim::example_plant();
  plant.basemat_mass = table.number_in("basemat_mass_kg", 1, 1e12, plant.basemat_mass);
  plant.damping_ratio = table.number_in("damping_ratio", 0, 0.99, plant.damping_ratio);
  plant.vertical_frequency =
      table.number_in("vertical_frequency_Hz", 0.1, 100, plant.vertical_frequency);
  plant.vertical_damping =
      table.number_in("vertical_damping_ratio", 0, 0.99, plant.vertical_damping);
  plant.bearings = static_cast<int>(table.integer_in("bearings", 1, 100'000, plant.bearings));
  plant.spectrum_elevation =
      table.number_in("spectrum_elevation_m", 0, 1000, plant.spectrum_elevation);
  plant.plan_long = table.number_in("plan_long_m", 1, 10'000, plant.plan_long);
  plant.plan_lat = table.number_in("plan_lat_m", 1, 10'000, plant.plan_lat);
  plant.bearing_long =
      table.number_in("bearing_long_m", -plant.plan_long / 2, plant.plan_long / 2, 0);
  plant.bearing_lat = table.number_in("bearing_lat_m", -plant.plan_lat / 2, plant.plan_lat / 2, 0);
  if (table.has("stick")) {
    plant.sticks.clear();
    for (const auto& stick : table.tables("stick")) plant.sticks.push_back(read_stick(stick));
  }
  table.reject_unknown_keys();
  return {std::move(plant), file.has("plant")};
}

}  // namespace rths::experiment
