// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/test_setup.hpp>

#include <cmath>

#include <fmt/format.h>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>

namespace rths::adapters {
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

sim::RecordComponent read_component(const Config& table, const std::string& key, int column) {
  if (!table.has("file") && !table.has("file_" + key))
    table.fail("file", "[motion] needs 'file', or 'file_long' and 'file_lat'");
  static_cast<void>(table.text("file", ""));  // each component may have its own
  const auto file =
      find_file(table, table.has("file_" + key) ? "file_" + key : "file", "examples/records");
  if (!sim::is_at2(file))
    return sim::read_column(file,
                            static_cast<int>(table.integer_in("column_" + key, 1, 100, column)));
  if (table.has("column_" + key))
    table.fail("column_" + key, fmt::format("column_{} has no effect: {} is an .AT2 file, which "
                                            "has one component",
                                            key, file.filename().string()));
  return sim::read_at2(file);
}

// A file of one component for all axes, or a file that each axis replaces by its own.
void check_files(const Config& table, const std::vector<std::string>& axes) {
  if (!table.has("file")) return;
  const auto has_own = [&](const std::string& key) { return table.has("file_" + key); };
  const bool needs_vertical = table.has("column_vert") && !has_own("vert");
  if (has_own("long") && has_own("lat") && !needs_vertical)
    table.fail("file", "file has no effect: each component has a file of its own");
  if (has_own("long") || has_own("lat") || axes.size() < 2) return;
  const auto file = find_file(table, "file", "examples/records");
  if (sim::is_at2(file))
    table.fail("file", fmt::format("{} is an .AT2 file, which has one component, and would drive "
                                   "both axes; expected file_long and file_lat, or axes with one",
                                   file.filename().string()));
}

// The components must come from one record.
void check_alike(const Config& table, const sim::RecordComponent& one,
                 const sim::RecordComponent& other) {
  if (one.values.size() != other.values.size() || std::abs(one.time_step - other.time_step) > 1e-9)
    table.fail("file", "the components differ in length or time step");
}

}  // namespace

sim::IsolatedPlant read_plant(const Config& table) {
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
  return plant;
}

sim::GroundMotion read_motion(const Config& table, const std::vector<std::string>& axes) {
  check_files(table, axes);
  const auto longitudinal = read_component(table, "long", 1);
  const auto lateral = read_component(table, "lat", 2);
  check_alike(table, longitudinal, lateral);
  const double scale = table.number_in("scale", 0, 100, 1.0) * kStandardGravity;
  static_cast<void>(table.text("name", ""));
  sim::GroundMotion motion;
  motion.time_step = longitudinal.time_step;
  motion.headings = {longitudinal.heading, lateral.heading};
  for (const double value : longitudinal.values) motion.long_acceleration.push_back(scale * value);
  for (const double value : lateral.values) motion.lat_acceleration.push_back(scale * value);
  if (table.has("column_vert") || table.has("file_vert")) {
    const auto vertical = read_component(table, "vert", 3);
    check_alike(table, longitudinal, vertical);
    motion.headings.push_back(vertical.heading);
    for (const double value : vertical.values) motion.vert_acceleration.push_back(scale * value);
  }
  table.reject_unknown_keys();
  return motion;
}

}  // namespace rths::adapters
