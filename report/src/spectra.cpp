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

SpectraAnalysis analyse_spectra(const Reader& run, const std::string& solver, double step,
                                const Reader* numerical, const Reader* improved) {
  SpectraAnalysis result;
  result.frequencies = sim::spectrum_frequencies(kLowest, kHighest, kFrequencies);
  const auto spectrum = [&](const std::vector<double>& along, const std::vector<double>& across,
                            double interval) {
    return sim::floor_spectrum(along, across, interval, result.frequencies, kDampingRatio);
  };
  const auto reference = [&](const Reader& companion, const std::string& name) {
    return spectrum(companion.signal("result." + name + "long"),
                    companion.signal("result." + name + "lat"),
                    numerical->time()[1] - numerical->time()[0]);
  };
  std::vector<std::string> names;
  if (numerical != nullptr) names = lines(numerical->config("floors"));
  const std::string monitor = "monitor." + solver;
  if (!run.has(monitor + ".floor.1.accel.long")) return result;
  const auto steps = run.signal(monitor + ".step");
  for (int floor = 1; run.has(fmt::format("{}.floor.{}.accel.long", monitor, floor)); ++floor) {
    const auto hybrid = [&](const char* axis) {
      return at_each_count(steps,
                           run.signal(fmt::format("{}.floor.{}.accel.{}", monitor, floor, axis)));
    };
    const auto index = static_cast<std::size_t>(floor - 1);
    FloorSpectra spectra;
    spectra.floor = index < names.size() ? names[index] : fmt::format("floor {}", floor);
    spectra.spectra.push_back({"hybrid", spectrum(hybrid("long"), hybrid("lat"), step)});
    const auto isolated = fmt::format("isolated.floor.{}.accel.", floor);
    // A response of the user's own has no floors.
    if (numerical != nullptr && numerical->has("result." + isolated + "long")) {
      spectra.spectra.push_back({"numerical", reference(*numerical, isolated)});
      if (improved != nullptr && improved->has("result." + isolated + "long"))
        spectra.spectra.push_back({"improved", reference(*improved, isolated)});
      const auto fixed = fmt::format("fixed.floor.{}.accel.", floor);
      if (numerical->has("result." + fixed + "long"))  // not of other solvers
        spectra.spectra.push_back({"fixed base", reference(*numerical, fixed)});
      spectra.spectra.push_back({"input", reference(*numerical, "ground.accel.")});
    }
    result.floors.push_back(std::move(spectra));
  }
  return result;
}

}  // namespace rths::report
