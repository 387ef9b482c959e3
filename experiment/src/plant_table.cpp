// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/constants.hpp>
#include <rths/core/sha256.hpp>
#include <rths/plant/large_plant.hpp>
#include <rths/plant/structure_files.hpp>

#include "tables.hpp"

namespace rths::experiment {
namespace {

constexpr long kLeastDofs = 4000, kMostDofs = 120'000;

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

std::shared_ptr<const sim::StructureModel> read_sticks(const Config& table) {
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
  return std::make_shared<sim::StickModel>(plant);
}

// "corner", "centre", or an index from 1, along lat first. A single bearing is at the centre.
std::size_t tested_bearing_of_ant(const Config& table, std::size_t bearings) {
  constexpr std::size_t kCentre =
      plant::kAntBearingsLong / 2 * plant::kAntBearingsLat + plant::kAntBearingsLat / 2;
  if (table.has("tested_bearing") && !table.is_text("tested_bearing"))
    return static_cast<std::size_t>(
        table.integer_in("tested_bearing", 1, static_cast<std::int64_t>(bearings)) - 1);
  const std::string name = table.text("tested_bearing", bearings == 1 ? "centre" : "corner");
  if (name == "corner" && bearings > 1) return 0;
  if (name != "centre")
    table.fail("tested_bearing",
               fmt::format("tested_bearing is '{}', expected {}centre or a number from 1 to {}",
                           name, bearings > 1 ? "corner, " : "", bearings));
  return bearings == plant::kAntBearings ? kCentre : bearings / 2;
}

// Bearings that are not tested are as [model] assumes the specimen, without what a diagnosis has
// found.
sim::Bearing others_of(const Config& file, double mass, std::size_t bearings) {
  const Config model = file.table_or_empty("model");
  static_cast<void>(model.texts("improvement", {}));
  const double mean_weight = mass * kStandardGravity / static_cast<double>(bearings);
  return read_assumed_model(model, {}, read_specimen(file), file.table_or_empty("machine"),
                            mean_weight)
      .bearing;
}

using Places = std::vector<std::array<double, 2>>;  // along long and lat [m]

// Whether a bearing is at the edge of the rectangle around all, or at a corner.
bool is_at(const std::string& name, const Places& places, std::size_t bearing) {
  int sides = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto along = [k](const auto& place) { return place[k]; };
    const auto [least, most] = std::ranges::minmax(places, {}, along);
    constexpr double kSame = 1e-6;  // of the side
    const double side = most[k] - least[k], at = places[bearing][k];
    if (at - least[k] <= kSame * side || most[k] - at <= kSame * side) ++sides;
  }
  return name == "inner" ? sides == 0 : sides >= (name == "corners" ? 2 : 1);
}

// "edge", "corners", "inner", or numbers from 1.
std::vector<std::size_t> read_places(const Config& kind, const Places& places) {
  std::vector<std::size_t> chosen;
  if (!kind.is_text("places")) {
    for (const double number : kind.numbers("places")) {
      if (!(number >= 1 && number <= static_cast<double>(places.size()) &&
            number == std::floor(number)))
        kind.fail("places", fmt::format("there is no place {:g}, expected whole numbers from 1 to "
                                        "{}",
                                        number, places.size()));
      chosen.push_back(static_cast<std::size_t>(number) - 1);
    }
    return chosen;
  }
  const std::string name = kind.text("places");
  if (name != "edge" && name != "corners" && name != "inner")
    kind.fail(
        "places",
        fmt::format("places is '{}', expected edge, corners, inner or a list of numbers", name));
  for (std::size_t i = 0; i < places.size(); ++i)
    if (is_at(name, places, i)) chosen.push_back(i);
  return chosen;
}

// [plant.bearing.NAME]: bearings of other kinds at some places.
void read_other_kinds(const Config& table, const Places& places,
                      plant::PlantDescription& description) {
  auto& [kinds, kind_of, vertical_stiffness, tension_share, stands_for] = description.bearings;
  const Config others = table.table_or_empty("bearing");
  std::vector<std::string> names{"[model]"};
  for (const auto& name : others.keys()) {
    const Config kind = others.table(name);
    for (const std::size_t place : read_places(kind, places)) {
      if (place == description.tested_bearing)
        kind.fail("places",
                  fmt::format("place {} has '{}', but its bearing is the tested one, expected the "
                              "specimen there",
                              place + 1, name));
      if (kind_of[place] != 0)
        kind.fail("places", fmt::format("place {} has '{}' and '{}', expected one kind", place + 1,
                                        names[kind_of[place]], name));
      kind_of[place] = kinds.size();
    }
    const Config bearing = read_bearing_with(kind.without("places"));
    static_cast<void>(bearing.text("model", ""));
    kinds.push_back(sim::read_bearing(bearing, kinds[0].axial_load));
    names.push_back(name);
  }
}

plant::PlantDescription describe_ant(const Config& table, const Config& file) {
  auto design = plant::ant_with(table.integer_in("dof", kLeastDofs, kMostDofs, 5'000));
  const auto bearings = table.integer_in("bearings", 1, plant::kAntBearings, plant::kAntBearings);
  design.bearings = static_cast<std::size_t>(bearings);
  const auto places =
      table.placed("bearings", [&] { return plant::ant_bearing_places(design.bearings); });
  auto description = plant::describe(design, others_of(file, design.mass(), plant::kAntBearings));
  description.tested_bearing = tested_bearing_of_ant(table, design.bearings);
  read_other_kinds(table, places, description);
  return description;
}

// Wrong units show in the weight on a bearing.
void check_weight(const Config& table, double mass, std::size_t bearings) {
  constexpr double kLeast = 1e3, kMost = 1e9;  // [N]
  const double weight = mass * kStandardGravity / static_cast<double>(bearings);
  if (!(weight >= kLeast && weight <= kMost))
    table.fail(
        "files",
        fmt::format("the weight on a bearing is {:.3g} N, expected {:g} to {:g}: is the mass "
                    "in kg?",
                    weight, kLeast, kMost));
}

plant::PlantDescription describe_files(const Config& table, const Config& file) {
  const auto folder = table.resolve(table.text("files"));
  const auto files = plant::StructureFiles::in(folder);
  const auto structure = std::make_shared<plant::Structure>(plant::read_structure(files));
  const double mass = structure->mass_along(plant::kDirections - 1);
  check_weight(table, mass, structure->bearings.size());
  plant::PlantDescription description;
  description.bearings = plant::BearingSet::all_of(
      others_of(file, mass, structure->bearings.size()), structure->bearings.size());
  description.structure = [structure] { return *structure; };
  for (const auto& each : {files.stiffness, files.mass, files.nodes, files.bearings, files.floors})
    description.key += sha256_of(each) + ' ';
  for (const auto& floor : structure->floors) description.floors.push_back(floor.name);
  description.tested_bearing = static_cast<std::size_t>(
      table.integer_in("tested_bearing", 1, std::ssize(structure->bearings), 1) - 1);
  Places places;
  for (const std::size_t node : structure->bearings) {
    const auto& place = structure->nodes[node].place;
    places.push_back({place[0], place[1]});
  }
  read_other_kinds(table, places, description);
  return description;
}

// What is recorded beside floors and loads.
void read_record(const Config& table, plant::PlantDescription& description) {
  for (const std::string& what : table.texts("record", {})) {
    if (what == "coordinates" && description.is_full)
      table.fail("record", "coordinates are those of basis = \"reduced\", found \"full\"");
    if (what == "coordinates")
      description.monitors_coordinates = true;
    else if (what == "energy")
      description.monitors_energy = true;
    else
      table.fail("record", "found '" + what + "', expected coordinates or energy");
  }
}

std::shared_ptr<const sim::StructureModel> read_large(const Config& table,
                                                      plant::PlantDescription description) {
  auto& bearings = description.bearings;
  bearings.vertical_stiffness =
      table.number_in("vertical_stiffness_N_per_m", 1e6, 1e13, bearings.vertical_stiffness);
  bearings.tension_share = table.number_in("tension_share", 0, 1, bearings.tension_share);
  description.frequency_limit =
      table.number_in("frequency_limit_Hz", 1, 1000, description.frequency_limit);
  description.damping_ratio = table.number_in("damping_ratio", 0, 0.5, description.damping_ratio);
  description.damping_frequency =
      table.number_in("damping_at_Hz", 0.01, 1000, description.damping_frequency);
  const std::string basis = table.text("basis", "reduced");
  if (basis != "reduced" && basis != "full")
    table.fail("basis", "basis is '" + basis + "', expected reduced or full");
  description.is_full = basis == "full";
  read_record(table, description);
  table.reject_unknown_keys();
  return std::make_shared<plant::LargePlant>(std::move(description), plant::cache_folder());
}

}  // namespace

Plant read_plant(const Config& file) {
  const Config table = file.table_or_empty("plant");
  const std::string model = table.text("model", "sticks");
  if (model == "ant") return {read_large(table, describe_ant(table, file)), true};
  if (model == "files") return {read_large(table, describe_files(table, file)), true};
  if (model != "sticks")
    table.fail("model", "model is '" + model + "', expected sticks, ant or files");
  return {read_sticks(table), file.has("plant")};
}

}  // namespace rths::experiment
