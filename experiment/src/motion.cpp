// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/axis.hpp>
#include <rths/core/constants.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/text.hpp>

namespace rths::experiment {
namespace {

/// One component of a motion, in g.
struct Component {
  double time_step = 0;  // [s]
  std::vector<double> values;
  sim::MotionSource source;
};

// A file of one column states no step.
double time_step_of(const Config& table, const sim::MotionFile& motion) {
  const std::string name = motion.file.filename().string();
  if (!table.has("time_step_s") && motion.time_step == 0)
    table.fail("time_step_s",
               fmt::format("{} has no column of time, expected time_step_s, its time "
                           "step",
                           name));
  if (!table.has("time_step_s")) return motion.time_step;
  const double stated = table.number_in("time_step_s", 1e-6, 1, 0.01);
  if (motion.time_step > 0)
    table.fail("time_step_s",
               fmt::format("time_step_s has no effect: {} states a time step of {:g} s", name,
                           motion.time_step));
  return stated;
}

// The order of a station's channels says nothing on their directions.
[[noreturn]] void fail_without_channel(const Config& table, const std::string& key,
                                       const sim::MotionFile& motion) {
  std::vector<std::string> channels;
  for (const auto& column : motion.columns)
    channels.push_back(fmt::format("{} '{}'", channels.size() + 1, column.heading));
  table.fail(table.has("file_" + key) ? "file_" + key : "file",
             fmt::format("{} has {} channels: {}; expected column_{} with the number of one",
                         motion.file.filename().string(), channels.size(),
                         fmt::join(channels, ", "), key));
}

// Whether a heading such as "UD [gal]" or "HNZ" is that of a vertical component.
bool is_vertical(const std::string& heading) {
  const std::string name = in_small_letters(heading.substr(0, heading.find_first_of(" _[(,.")));
  constexpr const char* kNames[] = {"ud", "u-d", "up",  "vert", "vertical",
                                    "z",  "hnz", "hlz", "bhz"};
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames);
}

void reject_vertical(const Config& table, const std::string& key, int column,
                     const sim::MotionFile& motion) {
  if (motion.columns.size() < static_cast<std::size_t>(column)) return;
  const auto& heading = motion.columns[static_cast<std::size_t>(column - 1)].heading;
  if (is_vertical(heading))
    table.fail("file", fmt::format("column {} of {} is '{}', a vertical component, expected "
                                   "column_{} with the number of a horizontal one",
                                   column, motion.file.filename().string(), heading, key));
}

int column_of(const Config& table, const std::string& key, int column,
              const sim::MotionFile& motion) {
  const std::string name = "column_" + key;
  if (!table.has(name) && motion.has_one_component()) return 1;
  if (!table.has(name) && motion.has_channels) fail_without_channel(table, key, motion);
  if (!table.has(name) && key != name_of(Axis::Vert)) reject_vertical(table, key, column, motion);
  if (!table.has(name)) return column;
  if (motion.is_at2())
    table.fail(name, fmt::format("{} has no effect: {} is an .AT2 file, which has one component",
                                 name, motion.file.filename().string()));
  if (motion.has_one_component() && motion.time_step == 0)
    table.fail(name, fmt::format("{} has no effect: {} has one column", name,
                                 motion.file.filename().string()));
  return static_cast<int>(table.integer_in(name, 1, 100, column));
}

Component read_component(const Config& table, const std::string& key, int column,
                         MotionFiles& files) {
  if (!table.has("file") && !table.has("file_" + key))
    table.fail("file", "[motion] needs 'file', or 'file_long' and 'file_lat'");
  static_cast<void>(table.text("file", ""));  // each component may have its own
  const std::string file_key = table.has("file_" + key) ? "file_" + key : "file";
  const auto file = find_file(table, file_key, "examples/records");
  const sim::MotionFile& motion = files.at(file);
  const int used = column_of(table, key, column, motion);
  Component component{time_step_of(table, motion), sim::acceleration_in_g(motion, used), {}};
  const auto& read = motion.columns[static_cast<std::size_t>(used - 1)];
  const auto& unit = read.stated.unit == nullptr ? sim::kUnitG : *read.stated.unit;
  component.source = {file,
                      read.heading,
                      std::string{unit.name},
                      unit.per_g,
                      motion.has_one_component() && !table.has("column_" + key),
                      read.values.size()};
  return component;
}

// A file that each axis replaces by its own.
void check_files(const Config& table) {
  if (!table.has("file")) return;
  const auto has_own = [&](const std::string& key) { return table.has("file_" + key); };
  const bool needs_vertical = table.has("column_vert") && !has_own(name_of(Axis::Vert));
  if (has_own(name_of(Axis::Long)) && has_own(name_of(Axis::Lat)) && !needs_vertical)
    table.fail("file", "file has no effect: each component has a file of its own");
}

// The components must come from one record.
void check_alike(const Config& table, const Component& one, const Component& other) {
  if (one.values.size() == other.values.size() && std::abs(one.time_step - other.time_step) <= 1e-9)
    return;
  table.fail("file",
             fmt::format("the components differ in length or time step: {} samples of {:g} "
                         "s, and {} of {:g} s",
                         one.values.size(), one.time_step, other.values.size(), other.time_step));
}

// Channels of one recorder begin together, but may end a few samples apart.
void extend(Component& one, Component& other, MotionFiles& files) {
  if (one.source.file != other.source.file || !files.at(one.source.file).has_channels) return;
  const std::size_t longest = std::max(one.values.size(), other.values.size());
  one.values.resize(longest);
  other.values.resize(longest);
}

sim::GroundMotion read_checked(const Config& table, Experiment& experiment) {
  MotionFiles files;
  auto motion = read_motion(table, files);
  for (auto& remark : check_motion(table, motion, experiment.axes))
    experiment.remarks.push_back(std::move(remark));
  return motion;
}

}  // namespace

const sim::MotionFile& MotionFiles::at(const std::filesystem::path& file) {
  const auto known = files_.find(file);
  if (known != files_.end()) return known->second;
  return files_.emplace(file, sim::read_motion_file(file)).first->second;
}

sim::GroundMotion read_motion(const Config& table, MotionFiles& files) {
  check_files(table);
  auto longitudinal = read_component(table, name_of(Axis::Long), 1, files);
  auto lateral = read_component(table, name_of(Axis::Lat), 2, files);
  std::optional<Component> vertical;
  if (table.has("column_vert") || table.has("file_vert"))
    vertical = read_component(table, name_of(Axis::Vert), 3, files);
  extend(longitudinal, lateral, files);
  if (vertical) extend(longitudinal, *vertical, files);
  extend(longitudinal, lateral, files);
  check_alike(table, longitudinal, lateral);
  const double scale = table.number_in("scale", 0, 100, 1.0) * kStandardGravity;
  static_cast<void>(table.text("name", ""));
  sim::GroundMotion motion;
  motion.time_step = longitudinal.time_step;
  motion.sources = {longitudinal.source, lateral.source};
  for (const double value : longitudinal.values) motion.long_acceleration.push_back(scale * value);
  for (const double value : lateral.values) motion.lat_acceleration.push_back(scale * value);
  if (vertical) {
    check_alike(table, longitudinal, *vertical);
    motion.sources.push_back(vertical->source);
    for (const double value : vertical->values) motion.vert_acceleration.push_back(scale * value);
  }
  table.reject_unknown_keys();
  return motion;
}

void read_earthquakes(const Config& file, Experiment& experiment) {
  const bool is_response = file.table_or_empty("targets").text("kind", "") == "response";
  auto& [name, motion] = experiment.earthquake;
  // A test with commanded displacements needs no ground motion.
  if (file.has("targets") && !file.has("motion") && !is_response) {
    name = "commanded displacements";
    motion = {experiment.time.integration_step, {0, 0}, {0, 0}};
  } else {
    const Config table = file.table("motion");
    name = table.text("name", table.text("file", ""));
    motion = read_checked(table, experiment);
  }
  // As with `uncompensated`, an empty table is none.
  if (const Config held_out = file.table_or_empty("held_out"); !held_out.keys().empty())
    experiment.held_out = read_checked(held_out, experiment);
}

}  // namespace rths::experiment
