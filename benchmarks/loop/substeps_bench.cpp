// SPDX-License-Identifier: Apache-2.0
//
// The error of the integration alone, for docs/theory/plant.md: hybrid tests with a perfect machine
// beside the purely numerical result. Prints JSON.
//
//     rths_substeps_bench REPOSITORY
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/loop/numerical_response.hpp>
#include <rths/sim/floor_spectrum.hpp>
#include <rths/sim/plant_analysis.hpp>

namespace {

using namespace rths;
using Eigen::Vector2d;

constexpr double kDuration = 30;        // [s]
constexpr double kSpecimenStep = 1e-3;  // and that of the numerical result [s]
constexpr double kAlpha = -0.05;

struct Record {
  const char* name;
  const char* file;
  std::array<int, 3> columns;  // long, lat, vert
  double scale;                // as in the example experiments
};
constexpr Record kRecords[] = {
    {"petrolia", "petrolia_1992_riodell_freefield.csv", {2, 1, 3}, 1.4},
    {"imperial_valley", "imperial_valley_1979_meloland_freefield.csv", {1, 2, 3}, 1.0}};

struct Case {
  const char* name;
  double step;  // [s]
  int substeps;
};
constexpr Case kCases[] = {{"10 ms", 0.01, 1},
                           {"5 ms", 0.005, 1},
                           {"10 ms, 2 substeps", 0.01, 2},
                           {"10 ms, 10 substeps", 0.01, 10}};

/// Targets, and floors, of a test whose machine follows the parabola through the last three
/// targets.
loop::ResponseHistory perfect_test(const sim::PlantMatrices& plant, const sim::GroundMotion& motion,
                                   const sim::Bearing& bearing, const Case& tried, double& us) {
  sim::PlantAnalysis analysis{plant,         motion, sim::initial_stiffness(bearing),
                              tried.step,    kAlpha, sim::VerticalFeedback::Model,
                              tried.substeps};
  sim::BearingRun specimen{bearing, kSpecimenStep};
  sim::BearingPath path;
  loop::ResponseHistory response;
  response.time_step = tried.step;
  response.floors.resize(plant.floors.size());
  const auto pieces = std::lround(tried.step / kSpecimenStep);
  const auto steps = std::lround(kDuration / tried.step);
  std::vector<double> times;
  for (long step = 0; step < steps; ++step) {
    const auto begun = std::chrono::steady_clock::now();
    path.append(analysis.predict());
    const auto predicted = std::chrono::steady_clock::now();
    Vector2d at = path.last, force = Vector2d::Zero();
    for (long k = 1; k <= pieces; ++k) {
      const Vector2d to = path.at(static_cast<double>(k) / static_cast<double>(pieces));
      force = specimen.advance(to, (to - at) / kSpecimenStep,
                               bearing.axial_load + analysis.vertical_force());
      at = to;
    }
    const auto measured = std::chrono::steady_clock::now();
    analysis.correct(force);
    const std::chrono::duration<double, std::micro> time =
        std::chrono::steady_clock::now() - measured + (predicted - begun);
    times.push_back(time.count());
    response.displacement_long.push_back(path.now[0]);
    response.displacement_lat.push_back(path.now[1]);
    for (std::size_t i = 0; i < response.floors.size(); ++i) {
      const Vector2d a = analysis.floor_acceleration(i);
      response.floors[i].acceleration_long.push_back(a[0]);
      response.floors[i].acceleration_lat.push_back(a[1]);
    }
  }
  std::nth_element(times.begin(), times.begin() + steps / 2, times.end());
  us = times[static_cast<std::size_t>(steps / 2)];
  return response;
}

std::vector<double> every(const std::vector<double>& values, std::size_t stride) {
  std::vector<double> found;
  for (std::size_t i = stride - 1; i < values.size(); i += stride) found.push_back(values[i]);
  return found;
}

double difference(const std::vector<double>& found, const std::vector<double>& expected) {
  double apart = 0, all = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    apart += (found[i] - expected[i]) * (found[i] - expected[i]);
    all += expected[i] * expected[i];
  }
  return std::sqrt(apart / all);
}

// Both spectra of accelerations at the same instants. The worst floor's, 6 to 11 Hz, rms.
double floor_difference(const loop::ResponseHistory& found, const loop::ResponseHistory& fine,
                        std::size_t stride) {
  const auto frequencies = sim::spectrum_frequencies(6, 11, 21);
  double worst = 0;
  for (std::size_t i = 0; i < found.floors.size(); ++i) {
    const auto& ours = found.floors[i];
    const auto spectrum = [&](const std::vector<double>& along, const std::vector<double>& across) {
      return sim::floor_spectrum(along, across, found.time_step, frequencies, 0.05);
    };
    const auto s = spectrum(ours.acceleration_long, ours.acceleration_lat);
    const auto reference = spectrum(every(fine.floors[i].acceleration_long, stride),
                                    every(fine.floors[i].acceleration_lat, stride));
    double sum = 0;
    for (std::size_t k = 0; k < s.size(); ++k) sum += std::pow(s[k] / reference[k] - 1, 2);
    worst = std::max(worst, std::sqrt(sum / static_cast<double>(s.size())));
  }
  return worst;
}

void measure(const std::filesystem::path& repository) {
  const auto description = sim::example_plant();
  const auto plant = sim::assemble(description);
  const auto bearing = sim::read_bearing(Config::load(repository / "sim/bearings/lprb.toml"),
                                         sim::weight_per_bearing(description));
  std::string rows;
  for (const auto& record : kRecords) {
    const auto motion = sim::read_motion(repository / "examples/records" / record.file,
                                         record.columns, record.scale);
    const auto fine =
        loop::numerical_response(sim::StickModel{plant}, motion, bearing, kSpecimenStep, kDuration);
    for (const auto& tried : kCases) {
      double us = 0;
      const auto found = perfect_test(plant, motion, bearing, tried, us);
      const auto stride = static_cast<std::size_t>(std::lround(tried.step / kSpecimenStep));
      rows += fmt::format(
          "{}\n  {{\"name\": \"{}, {}\", \"long\": {:.6f}, \"lat\": {:.6f}, \"floors\": {:.6f}, "
          "\"step_us\": {:.2f}}}",
          rows.empty() ? "" : ",", record.name, tried.name,
          difference(found.displacement_long, every(fine.displacement_long, stride)),
          difference(found.displacement_lat, every(fine.displacement_lat, stride)),
          floor_difference(found, fine, stride), us);
    }
  }
  fmt::print("{{\"duration_s\": {}, \"rows\": [{}\n]}}\n", kDuration, rows);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: rths_substeps_bench REPOSITORY\n");
    return 2;
  }
  try {
    measure(argv[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "rths_substeps_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
