// SPDX-License-Identifier: Apache-2.0
#include "plant/drive.hpp"

#include <algorithm>
#include <cmath>

#include <rths/sim/floor_spectrum.hpp>

#include "support/files.hpp"

namespace rths::plant::test {
namespace {

std::vector<double> column(const MatrixXd& table, Index i) {
  return {table.col(i).begin(), table.col(i).end()};
}

}  // namespace

sim::GroundMotion petrolia(double scale) {
  return sim::read_motion(
      rths::test::source_tree() / "examples/records/petrolia_1992_riodell_freefield.csv", {2, 1, 3},
      scale);
}

Response drive(LargePlantAnalysis& plant, const sim::Bearing& tested, double time_step,
               double duration) {
  const auto steps = static_cast<Index>(std::lround(duration / time_step));
  sim::BearingRun specimen{tested, time_step};
  std::array<double, 3> target{}, rate{}, force{};
  std::vector<double> monitored(plant.monitors().size());
  Response response{time_step, MatrixXd(steps, 2), MatrixXd(steps, 1),
                    MatrixXd(steps, static_cast<Index>(monitored.size()) - 6)};
  for (Index i = 0; i < steps; ++i) {
    plant.predict(target, rate);
    plant.work_ahead();
    const Eigen::Vector2d felt =
        specimen.advance({target[0], target[1]}, {rate[0], rate[1]}, tested.axial_load);
    force = {felt[0], felt[1], 0};
    plant.correct(force);
    plant.monitor(monitored);
    response.tested.row(i) << target[0], target[1];
    response.loads(i, 0) = target[2];
    for (Index k = 0; k < response.floors.cols(); ++k)
      response.floors(i, k) = monitored[static_cast<std::size_t>(k + 3)];
  }
  return response;
}

double difference(const MatrixXd& found, const MatrixXd& reference) {
  return 100 * (found - reference).norm() / reference.norm();
}

double spectral_difference(const Response& found, const Response& reference) {
  std::vector<double> frequencies;
  constexpr int kCount = 80;
  for (int i = 0; i < kCount; ++i)
    frequencies.push_back(0.3 * std::pow(33 / 0.3, static_cast<double>(i) / (kCount - 1)));
  const auto spectrum = [&](const Response& response, Index floor, bool is_vertical) {
    const std::vector<double> none(static_cast<std::size_t>(response.floors.rows()), 0.0);
    const auto x = column(response.floors, 3 * floor + (is_vertical ? 2 : 0));
    const auto y = is_vertical ? none : column(response.floors, 3 * floor + 1);
    return sim::floor_spectrum(x, y, response.time_step, frequencies, 0.05);
  };
  double largest = 0;
  for (Index floor = 0; floor < found.floors.cols() / 3; ++floor)
    for (const bool is_vertical : {false, true}) {
      const auto mine = spectrum(found, floor, is_vertical),
                 theirs = spectrum(reference, floor, is_vertical);
      for (std::size_t i = 0; i < mine.size(); ++i)
        largest = std::max(largest, 100 * std::abs(mine[i] / theirs[i] - 1));
    }
  return largest;
}

}  // namespace rths::plant::test
