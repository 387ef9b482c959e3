// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/core/error.hpp>
#include <rths/core/message.hpp>
#include <rths/plant/large_plant.hpp>
#include <rths/plant/reduction_check.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

using plant::LargePlant;
using Clock = std::chrono::steady_clock;

struct PlantArguments {
  std::string file;
  std::vector<std::string> sets;  ///< key=value
  Changes changes;
  int modes = 20;         ///< to show
  double duration_s = 10; ///< of the motion to check; 0: all of it
};

void split_sets(PlantArguments& given) { given.changes = split_changes(given.sets); }

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

const LargePlant& large_plant_of(const experiment::Experiment& experiment) {
  const auto* large = dynamic_cast<const LargePlant*>(experiment.plant.structure.get());
  if (large != nullptr) return *large;
  throw Error{fmt::format(
      "{}: the plant is one of sticks, expected [plant] with model = \"ant\" or \"files\"",
      experiment.file.string())};
}

sim::AnalysisSettings settings_of(const experiment::Experiment& experiment) {
  sim::AnalysisSettings settings;
  settings.motion = experiment.earthquake.motion;
  settings.time_step = experiment.time.integration_step;
  settings.alpha = experiment.solver.alpha;
  settings.substeps = experiment.solver.substeps;
  return settings;
}

// Computes all modes that a test needs, on bearings and on a fixed base.
int build(const PlantArguments& a) {
  const auto begin = Clock::now();
  const auto experiment = load_experiment(a.file, a.changes);
  const LargePlant& large = large_plant_of(experiment);
  static_cast<void>(large.analysis_on_fixed_base(settings_of(experiment)));
  const auto folder = plant::cache_folder();
  fmt::print("{}\n{:.1f} s; {}\n", large.summary(), seconds_since(begin),
             folder ? "the modes are in " + folder->string()
                    : "the modes are not kept: neither XDG_CACHE_HOME nor HOME is set");
  return kOk;
}

// Shares of the mass that moves in a mode, in long, lat and vert.
void print_modes(const plant::Basis& basis, int count) {
  fmt::print("modes on the bearings' initial stiffness, and the share of the mass in each [%]\n");
  fmt::print("        Hz    long     lat    vert\n");
  for (plant::Index i = 0; i < std::min<plant::Index>(count, basis.coordinates()); ++i) {
    fmt::print("  {:>8.4f}", std::sqrt(basis.stiffness[i]) / (2 * std::numbers::pi));
    for (std::size_t k = 0; k < plant::kDirections; ++k) {
      const double part = basis.participation(i, static_cast<plant::Index>(k));
      fmt::print("  {:>6.2f}", 100 * part * part / basis.mass[k]);
    }
    fmt::print("\n");
  }
}

void print_yielded(const plant::Basis& basis) {
  fmt::print("modes on yielded bearings, {} up to the limit:", basis.frequencies.size() - 1);
  for (plant::Index i = 0; i < std::min<plant::Index>(10, basis.frequencies.size()); ++i)
    fmt::print(" {:.4g}", basis.frequencies[i]);
  fmt::print(" … {:.4g} Hz\n", basis.frequencies[basis.frequencies.size() - 1]);
}

void print_loads(const LargePlant& large) {
  const auto& weights = large.basis().weights;
  plant::Index least = 0, most = 0;
  const double smallest = weights.minCoeff(&least), largest = weights.maxCoeff(&most);
  fmt::print(
      "loads of the bearings at rest: {:.3f} MN on number {} to {:.3f} MN on number {}, mean "
      "{:.3f} MN; number {} is tested: {:.3f} MN\n",
      1e-6 * smallest, least + 1, 1e-6 * largest, most + 1, 1e-6 * weights.mean(),
      large.description().tested_bearing + 1, 1e-6 * large.weight());
}

int show(const PlantArguments& a) {
  const auto experiment = load_experiment(a.file, a.changes);
  const LargePlant& large = large_plant_of(experiment);
  const plant::Basis& basis = large.basis();
  fmt::print("{}\n", large.summary());
  print_modes(basis, a.modes);
  print_yielded(basis);
  print_loads(large);
  const auto numbers = basis.bearings.size() + basis.floors.size() + basis.participation.size();
  fmt::print("{} modes and {} static vectors; a step reads {:.2f} MB\n", basis.frequencies.size(),
             basis.static_vectors(), 8e-6 * static_cast<double>(numbers));
  return kOk;
}

void warn_of_few_modes(const plant::Basis& basis) {
  const double reached = basis.frequencies[basis.frequencies.size() - 1];
  const double expected = plant::kModesOverSpectra * plant::kHighestOfSpectra;
  if (reached < expected)
    write_message(
        fmt::format("rths: the modes reach {:.3g} Hz, expected {:.3g} Hz, {:g} times the highest "
                    "frequency of the spectra: raise frequency_limit_Hz of [plant]\n",
                    reached, expected, plant::kModesOverSpectra));
}

plant::PlantResponse response_of(const LargePlant& large, const experiment::Experiment& experiment,
                                 double duration) {
  const auto settings = settings_of(experiment);
  const auto analysis = large.analysis(settings);
  sim::Bearing tested = experiment.model.bearing;
  tested.axial_load = large.weight();
  return plant::response_of(*analysis, tested, settings.time_step, duration);
}

// The reduced plant against the full one, both with a computed specimen.
int check(const PlantArguments& a) {
  const auto experiment = load_experiment(a.file, a.changes);
  const LargePlant& given = large_plant_of(experiment);
  const double all = experiment.time.duration;
  const double duration = a.duration_s > 0 ? std::min(a.duration_s, all) : all;
  auto description = given.description();
  description.is_full = false;
  const LargePlant reduced{description, plant::cache_folder()};
  description.is_full = true;
  const LargePlant full{description, plant::cache_folder()};
  warn_of_few_modes(reduced.basis());
  const auto found = response_of(reduced, experiment, duration),
             reference = response_of(full, experiment, duration);
  const auto floors = plant::spectral_differences(found, reference);
  fmt::print("reduced against full, {:g} s of '{}' in steps of {:g} ms\n", duration,
             experiment.earthquake.name, 1e3 * experiment.time.integration_step);
  fmt::print("  {:<36} {:.5f} % of {:.3g} mm\n", "displacement of the tested bearing",
             100 * plant::relative_difference(found.tested, reference.tested),
             1e3 * reference.tested.cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < floors.size(); ++i)
    fmt::print("  {:<36} {:.3f} % horizontal, {:.3f} % vertical\n",
               fmt::format("spectra to {:g} Hz of {}", plant::kHighestOfSpectra,
                           given.description().floors[i]),
               100 * floors[i].horizontal, 100 * floors[i].vertical);
  return kOk;
}

}  // namespace

void add_plant(CommandLine& line) {
  auto* group = line.app.add_subcommand("plant", "Work with the large plant of an experiment");
  group->require_subcommand(1);
  const auto add = [&](const char* name, const char* description,
                       int (*work)(const PlantArguments&)) {
    auto [command, a] = line.add_to(*group, name, description, work, split_sets);
    command->add_option("file", a.file, "Experiment")->required()->check(CLI::ExistingFile);
    repeatable(command->add_option("--set", a.sets,
                                   "Override a key of the experiment, as in rths run: key=value"));
    return std::pair<CLI::App*, PlantArguments&>{command, a};
  };
  add("build", "Compute the modes that a test of this plant needs, and keep them", build);
  auto [shown, show_values] =
      add("show", "Print size, modes, masses that move in them, and loads of the bearings", show);
  shown->add_option("--modes", show_values.modes, "Modes to print")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  auto [checked, check_values] =
      add("check",
          "Compare the reduced plant with one of all degrees of freedom, a solution a step", check);
  checked
      ->add_option("--duration-s", check_values.duration_s,
                   "Length of the motion from its begin; 0: all of it")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

}  // namespace rths::app
