// SPDX-License-Identifier: Apache-2.0
#include <rths/session/plant.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/loop/response_difference.hpp>

#include "large_plant_of.hpp"

namespace rths::session {
namespace {

using experiment::Experiment;
using plant::Basis;
using plant::Index;
using plant::LargePlant;

// Of the highest frequency of the spectra. Measured with time steps of 1 ms.
constexpr double kModesOverSpectra = 1.4;

sim::AnalysisSettings settings_of(const Experiment& experiment) {
  sim::AnalysisSettings settings;
  settings.motion = experiment.tested_motion();
  settings.time_step = experiment.time.integration_step;
  return settings;
}

// Shares of the mass that moves in a mode, in long, lat and vert.
std::string modes_of(const Basis& basis, int count) {
  std::string text =
      "modes on the bearings' initial stiffness, and the share of the mass in each [%]\n"
      "        Hz    long     lat    vert\n";
  const Eigen::VectorXd frequencies = basis.initial_frequencies();
  const Eigen::MatrixXd shares = 100 * basis.mass_shares();
  for (Index i = 0; i < std::min<Index>(count, basis.coordinates()); ++i)
    text += fmt::format("  {:>8.4f}  {:>6.2f}  {:>6.2f}  {:>6.2f}\n", frequencies[i], shares(i, 0),
                        shares(i, 1), shares(i, 2));
  return text;
}

std::string yielded_modes_of(const Basis& basis) {
  const Index count = basis.frequencies.size(), shown = std::min<Index>(10, count);
  std::string text = fmt::format("{} modes on yielded bearings:", count);
  for (Index i = 0; i < shown; ++i) text += fmt::format(" {:.4g}", basis.frequencies[i]);
  return text + fmt::format(" … {:.4g} Hz; {} static vectors\n", basis.frequencies[count - 1],
                            basis.static_vectors());
}

std::string loads_of(const LargePlant& large) {
  const auto& weights = large.basis().weights;
  Index least = 0, most = 0;
  const double smallest = weights.minCoeff(&least), largest = weights.maxCoeff(&most);
  return fmt::format(
      "loads of the bearings at rest: {:.3f} MN on number {} to {:.3f} MN on number {}, mean "
      "{:.3f} MN; number {} is tested: {:.3f} MN\n",
      1e-6 * smallest, least + 1, 1e-6 * largest, most + 1, 1e-6 * weights.mean(),
      large.description().tested_bearing + 1, 1e-6 * large.weight());
}

// Empty if there are enough modes.
std::string warning_of(const Basis& basis) {
  const double reached = basis.frequencies[basis.frequencies.size() - 1];
  const double expected = kModesOverSpectra * loop::kHighestOfSpectra;
  if (reached >= expected) return "";
  return fmt::format(
      "  warning: the modes reach {:.3g} Hz, expected {:.3g} Hz, {:g} times the highest frequency "
      "of "
      "the spectra: raise frequency_limit_Hz of [plant]\n",
      reached, expected, kModesOverSpectra);
}

loop::ResponseHistory response_of(plant::PlantDescription description, bool is_full,
                                  const Experiment& experiment, double duration) {
  description.is_full = is_full;
  const LargePlant large{std::move(description), plant::cache_folder()};
  return loop::numerical_response(large, experiment.tested_motion(), experiment.model.bearing,
                                  experiment.time.integration_step, duration);
}

}  // namespace

const LargePlant& large_plant_of(const Experiment& experiment) {
  const auto* large = dynamic_cast<const LargePlant*>(experiment.plant.structure.get());
  if (large != nullptr) return *large;
  throw Error{fmt::format(
      "{}: the plant is one of sticks, expected [plant] with model = \"ant\" or \"files\"",
      experiment.file.string())};
}

std::string build_plant(const Experiment& experiment) {
  const LargePlant& large = large_plant_of(experiment);
  static_cast<void>(large.analysis_on_fixed_base(settings_of(experiment)));
  const auto folder = plant::cache_folder();
  return fmt::format("{}\n{}\n", large.summary(),
                     folder ? "its modes are in " + folder->string()
                            : "its modes are not kept: neither XDG_CACHE_HOME nor HOME is set");
}

std::string describe_plant(const Experiment& experiment, int modes) {
  const LargePlant& large = large_plant_of(experiment);
  const Basis& basis = large.basis();
  const auto numbers = basis.bearings.size() + basis.floors.size() + basis.participation.size();
  return large.summary() + "\n" + modes_of(basis, modes) + yielded_modes_of(basis) +
         loads_of(large) +
         fmt::format("the basis takes {:.1f} MB\n", 8e-6 * static_cast<double>(numbers));
}

std::string check_plant(const Experiment& experiment, double duration) {
  const LargePlant& large = large_plant_of(experiment);
  const double length = std::min(duration, experiment.time.duration);
  const auto found = response_of(large.description(), false, experiment, length),
             reference = response_of(large.description(), true, experiment, length);
  double peak = 0;
  for (std::size_t i = 0; i < reference.displacement_long.size(); ++i)
    peak =
        std::max(peak, std::hypot(reference.displacement_long[i], reference.displacement_lat[i]));
  std::string text =
      fmt::format("reduced against full, {:g} s of '{}' in steps of {:g} ms\n", length,
                  experiment.earthquake.name, 1e3 * experiment.time.integration_step);
  text +=
      fmt::format("  {:<36} {:.5f} %, of at most {:.3g} mm\n", "displacement of the tested bearing",
                  100 * loop::displacement_difference(found, reference), 1e3 * peak);
  const auto differences = loop::spectral_differences(found, reference);
  for (std::size_t i = 0; i < differences.size(); ++i)
    text += fmt::format(
        "  {:<36} {:.3f} % horizontal, {:.3f} % vertical\n",
        fmt::format("spectra to {:g} Hz of {}", loop::kHighestOfSpectra, reference.floors[i].name),
        100 * differences[i].horizontal, 100 * differences[i].vertical);
  return text + warning_of(large.basis());
}

}  // namespace rths::session
