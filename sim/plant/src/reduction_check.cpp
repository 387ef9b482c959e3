// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/reduction_check.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <rths/sim/floor_spectrum.hpp>

namespace rths::plant {
namespace {

constexpr double kLowestOfSpectra = 0.3, kDampingRatio = 0.05;
constexpr int kFrequencies = 80;

using Values = std::vector<double>;

Values column(const MatrixXd& table, Index i) { return {table.col(i).begin(), table.col(i).end()}; }

Values horizontal_spectrum(const PlantResponse& response, Index floor, const Values& frequencies) {
  const Index first = static_cast<Index>(kDirections) * floor;
  return sim::floor_spectrum(column(response.floors, first), column(response.floors, first + 1),
                             response.time_step, frequencies, kDampingRatio);
}

Values vertical_spectrum(const PlantResponse& response, Index floor, const Values& frequencies) {
  const Index vert = static_cast<Index>(kDirections) * floor + 2;
  const Values none(static_cast<std::size_t>(response.floors.rows()), 0.0);
  return sim::floor_spectrum(column(response.floors, vert), none, response.time_step, frequencies,
                             kDampingRatio);
}

double largest_difference(const Values& found, const Values& reference) {
  double largest = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (reference[i] != found[i])
      largest = std::max(largest, std::abs(found[i] - reference[i]) / reference[i]);
  return largest;
}

}  // namespace

PlantResponse response_of(sim::Substructure& plant, const sim::Bearing& tested, double time_step,
                          double duration) {
  const auto steps = static_cast<Index>(std::lround(duration / time_step));
  sim::BearingRun specimen{tested, time_step};
  std::array<double, kDirections> target{}, rate{}, force{};
  Values monitored(plant.monitors().size());
  const Index ground = kDirections;
  PlantResponse response{time_step, MatrixXd(steps, 2),
                         MatrixXd(steps, static_cast<Index>(monitored.size()) - ground)};
  for (Index i = 0; i < steps; ++i) {
    plant.predict(target, rate);
    plant.work_ahead();
    const Eigen::Vector2d felt =
        specimen.advance({target[0], target[1]}, {rate[0], rate[1]}, tested.axial_load);
    force = {felt[0], felt[1], 0};
    plant.correct(force);
    plant.monitor(monitored);
    response.tested.row(i) << target[0], target[1];
    response.floors.row(i) =
        Eigen::RowVectorXd::Map(monitored.data() + ground, response.floors.cols());
  }
  return response;
}

double relative_difference(const MatrixXd& found, const MatrixXd& reference) {
  return (found - reference).norm() / reference.norm();
}

std::vector<SpectralDifference> spectral_differences(const PlantResponse& found,
                                                     const PlantResponse& reference) {
  const Values frequencies =
      sim::spectrum_frequencies(kLowestOfSpectra, kHighestOfSpectra, kFrequencies);
  std::vector<SpectralDifference> differences;
  for (Index floor = 0; floor < found.floors.cols() / static_cast<Index>(kDirections); ++floor) {
    const auto difference = [&](auto spectrum) {
      return largest_difference(spectrum(found, floor, frequencies),
                                spectrum(reference, floor, frequencies));
    };
    differences.push_back({difference(horizontal_spectrum), difference(vertical_spectrum)});
  }
  return differences;
}

}  // namespace rths::plant
