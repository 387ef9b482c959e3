// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/sim/floor_spectrum.hpp>

#include "analysis.hpp"

namespace rths::report {
namespace {

constexpr double kDampingRatio = 0.05;
constexpr double kLowest = 0.2, kHighest = 33;  // [Hz], the band of nuclear practice
constexpr int kFrequencies = 160;

}  // namespace

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::size_t start = 0;
  for (auto end = text.find('\n'); end != std::string::npos; end = text.find('\n', start)) {
    result.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return result;
}

void add_spectra(Analysis& analysis, const recording::Reader& run, const std::string& solver,
                 const recording::Reader* numerical, const recording::Reader* improved) {
  analysis.frequencies = sim::spectrum_frequencies(kLowest, kHighest, kFrequencies);
  const auto spectrum = [&](const std::vector<double>& along, const std::vector<double>& across,
                            double interval) {
    return sim::floor_spectrum(along, across, interval, analysis.frequencies, kDampingRatio);
  };
  const auto reference = [&](const recording::Reader& result, const std::string& name) {
    return spectrum(result.signal("result." + name + "long"),
                    result.signal("result." + name + "lat"), analysis.numerical_interval);
  };
  std::vector<std::string> names;
  if (numerical != nullptr) names = lines(numerical->config("floors"));
  const std::string monitor = "monitor." + solver;
  if (!run.has(monitor + ".floor.1.accel.long")) {
    analysis.left_out.push_back(
        {"floor spectra", fmt::format("the solver '{}' records no floor accelerations", solver)});
    return;
  }
  const auto steps = run.signal(monitor + ".step");
  for (int floor = 1; run.has(fmt::format("{}.floor.{}.accel.long", monitor, floor)); ++floor) {
    const auto hybrid = [&](const char* axis) {
      return recording::at_each_count(
          steps, run.signal(fmt::format("{}.floor.{}.accel.{}", monitor, floor, axis)));
    };
    const auto index = static_cast<std::size_t>(floor - 1);
    FloorSpectra spectra;
    spectra.floor = index < names.size() ? names[index] : fmt::format("floor {}", floor);
    spectra.spectra.push_back(
        {"hybrid", spectrum(hybrid("long"), hybrid("lat"), analysis.integration_step)});
    const auto isolated = fmt::format("isolated.floor.{}.accel.", floor);
    // A response of the user's own, or one of other solvers, has no floors.
    if (numerical != nullptr && numerical->has("result." + isolated + "long")) {
      const auto fixed = fmt::format("fixed.floor.{}.accel.", floor);
      spectra.spectra.push_back({"numerical", reference(*numerical, isolated)});
      if (improved != nullptr && improved->has("result." + isolated + "long"))
        spectra.spectra.push_back({"improved", reference(*improved, isolated)});
      spectra.spectra.push_back({"fixed base", reference(*numerical, fixed)});
      spectra.spectra.push_back({"input", reference(*numerical, "ground.accel.")});
    }
    analysis.floors.push_back(std::move(spectra));
  }
}

}  // namespace rths::report
