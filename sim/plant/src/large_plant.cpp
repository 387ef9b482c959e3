// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/large_plant.hpp>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/core/message.hpp>
#include <rths/plant/basis_file.hpp>

#include "fixed_plant.hpp"

namespace rths::plant {
namespace {

std::string text_of(const sim::Bearing& bearing) {
  std::string text =
      fmt::format("load {:.17g} temperature {:.17g}", bearing.axial_load, bearing.temperature);
  for (const auto& term : bearing.terms) {
    text += fmt::format(" {} {} axes {}", term.kind, sim::name_of(term), term.axes);
    for (const auto& [name, value] : term.parameters)
      text += fmt::format(" {} {:.17g}", name, value);
  }
  return text;
}

std::string key_of(const PlantDescription& plant) {
  const BearingSet& bearings = plant.bearings;
  std::string kinds;
  for (const auto& kind : bearings.kinds) kinds += text_of(kind) + "; ";
  return fmt::format(
      "{}; kinds {}of bearings {}, each for {:.17g}; vertical {:.17g}; modes to {:.17g} Hz; "
      "tested {}",
      plant.key, kinds, fmt::join(bearings.kind_of, " "), bearings.stands_for,
      bearings.vertical_stiffness, plant.frequency_limit, plant.tested_bearing);
}

void say_that_it_takes_long(const char* what) {
  write_message(fmt::format("computing the modes of the {}\n", what));
}

// Wrong units of mass or stiffness show in the first frequencies.
void check_frequencies(const Basis& basis, const BearingSet& bearings) {
  constexpr double kLeast = 0.02, kMost = 20;  // on yielded bearings [Hz]
  constexpr double kSoftest = 0.2;             // of a rigid structure's frequency
  const double first = basis.frequencies[0];
  if (!(first >= kLeast && first <= kMost))
    throw Error{fmt::format(
        "the plant's first frequency is {:.3g} Hz on yielded bearings, expected {:g} to {:g} Hz: "
        "are its masses in kg?",
        first, kLeast, kMost)};
  double stiffness = 0;
  for (const auto& springs : stiffness_of(bearings))
    stiffness += bearings.stands_for * springs.initial[0];
  const double found = basis.initial_frequencies()[0],
               rigid = std::sqrt(stiffness / basis.mass[0]) / (2 * std::numbers::pi);
  if (found < kSoftest * rigid)
    throw Error{
        fmt::format("the plant's first frequency is {:.3g} Hz, but {:.3g} Hz if only its bearings "
                    "were flexible: is its stiffness in N/m?",
                    found, rigid)};
}

std::vector<Floor> named(const std::vector<std::string>& names) {
  std::vector<Floor> floors;
  for (const auto& name : names) floors.push_back({name, 0});
  return floors;
}

PlantSettings settings_of(const PlantDescription& description,
                          const sim::AnalysisSettings& settings) {
  PlantSettings plant;
  plant.time_step = settings.time_step;
  plant.alpha = settings.alpha;
  plant.damping_ratio = description.damping_ratio;
  plant.damping_frequency = description.damping_frequency;
  plant.tested_bearing = description.tested_bearing;
  plant.substeps = settings.substeps;
  plant.measures_vertical = settings.vertical == sim::VerticalFeedback::Measured;
  plant.counts_energy = description.monitors_energy;
  plant.monitors_coordinates = description.monitors_coordinates;
  return plant;
}

BasisSettings basis_settings(const PlantDescription& description) {
  BasisSettings settings;
  settings.frequency_limit = description.frequency_limit;
  settings.tested_bearing = description.tested_bearing;
  return settings;
}

}  // namespace

PlantDescription describe(const AntDesign& design, const sim::Bearing& bearing) {
  PlantDescription plant;
  const bool has_all = design.bearings == kAntBearings;
  plant.structure = [design, has_all] {
    const AntMesh mesh = mesh_of(design);
    return has_all ? assemble(mesh) : assemble_on_rigid_mat(mesh, design.bearings);
  };
  plant.key =
      fmt::format("ant {} {} {}; masses {:.17g}; frequencies {:.17g}; {:.17g} Pa {:.17g}",
                  design.plan, design.mat_layers, design.levels, fmt::join(design.masses, " "),
                  fmt::join(design.frequencies, " "), design.basemat_modulus, design.poisson_ratio);
  if (!has_all) plant.key += "; rigid mat";
  plant.floors.assign(kAntFloors.begin(), kAntFloors.end());
  plant.bearings = BearingSet::all_of(bearing, design.bearings);
  plant.bearings.stands_for =
      static_cast<double>(kAntBearings) / static_cast<double>(design.bearings);
  return plant;
}

std::optional<std::filesystem::path> cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/')
    return std::filesystem::path{cache} / "rths";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    return std::filesystem::path{home} / ".cache/rths";
  return std::nullopt;
}

LargePlant::LargePlant(PlantDescription description, std::optional<std::filesystem::path> cache)
    : description_{std::move(description)},
      cache_{std::move(cache)},
      basis_{basis_for(cache_, key_of(description_), [this] {
        say_that_it_takes_long("plant");
        const Structure structure = description_.structure();
        check(structure);
        return make_basis(structure, description_.bearings, basis_settings(description_));
      })} {
  check_frequencies(basis_, description_.bearings);
}

Basis LargePlant::basis_of(const Structure& structure) const {
  say_that_it_takes_long("plant");
  BasisSettings settings = basis_settings(description_);
  settings.keeps_all_shapes = true;
  return make_basis(structure, description_.bearings, settings);
}

std::string LargePlant::summary() const {
  const auto places = static_cast<double>(basis_.weights.size());
  const double bearings = places * description_.bearings.stands_for;
  return fmt::format(
      "plant: {} degrees of freedom in {} coordinates, {:.0f} t on {:.0f} bearings{} that carry "
      "{:.3g} to {:.3g} MN; the tested one carries {:.3g} MN; {:.3g} Hz on yielded bearings",
      basis_.dofs, basis_.coordinates(), basis_.mass[0] * 1e-3, bearings,
      bearings > places ? fmt::format(", modelled by {},", places) : "",
      basis_.weights.minCoeff() * 1e-6, basis_.weights.maxCoeff() * 1e-6, weight() * 1e-6,
      basis_.frequencies[0]);
}

std::optional<sim::StructureSketch> LargePlant::sketch() const {
  sim::StructureSketch sketch;
  sketch.nodes = basis_.nodes;
  sketch.bearings = basis_.bearing_places;
  sketch.loads = basis_.weights;
  sketch.tested = description_.tested_bearing;
  sketch.shapes = basis_.shapes;
  const Index modes = basis_.shapes.cols();
  sketch.frequencies = basis_.initial_frequencies().head(modes);
  sketch.mass_shares = basis_.mass_shares().topRows(modes);
  return sketch;
}

std::unique_ptr<sim::Substructure> LargePlant::analysis(
    const sim::AnalysisSettings& settings) const {
  const PlantSettings plant = settings_of(description_, settings);
  if (description_.is_full)
    return make_full(description_.structure(), description_.bearings, settings.motion, plant);
  return make_reduced(basis_, description_.bearings, settings.motion, named(description_.floors),
                      plant);
}

std::unique_ptr<sim::Substructure> LargePlant::analysis_on_fixed_base(
    const sim::AnalysisSettings& settings) const {
  const Basis fixed = basis_for(cache_, "fixed; " + key_of(description_), [&] {
    say_that_it_takes_long("plant on a fixed base");
    return fixed_basis(description_.structure(), description_.frequency_limit);
  });
  return make_fixed(fixed, settings.motion, settings.time_step,
                    settings_of(description_, settings).damping_time());
}

}  // namespace rths::plant
