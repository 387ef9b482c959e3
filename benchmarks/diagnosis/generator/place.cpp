// SPDX-License-Identifier: Apache-2.0
#include "place.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

namespace trial {
namespace {

PlacedEnergy placed(std::vector<double> energy) {
  constexpr double kShare = 0.8;
  std::vector<std::size_t> order(energy.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return energy[a] > energy[b]; });
  const double whole = std::accumulate(energy.begin(), energy.end(), 0.0);
  std::vector<std::size_t> cells;
  double held = 0;
  for (const std::size_t cell : order) {
    if (held >= kShare * whole) break;
    held += energy[cell];
    cells.push_back(cell);
  }
  std::sort(cells.begin(), cells.end());
  for (double& one : energy) one /= whole > 0 ? whole : 1;
  return {std::move(cells), std::move(energy)};
}

std::size_t cell_of(double value, double range) {
  const double cell = std::floor((value / range + 1) / 2 * kStateCells);
  return static_cast<std::size_t>(std::clamp(cell, 0.0, double{kStateCells - 1}));
}

std::vector<double> energy_in_frequency(const Signal& signal, std::size_t samples) {
  const std::vector<double> edges = third_octaves();
  std::vector<double> energy(edges.size() - 1, 0);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    Spectrum spectrum(std::bit_ceil(samples));
    for (std::size_t k = 0; k < samples; ++k) spectrum[k] = signal[axis * samples + k];
    fourier(spectrum, false);
    for (std::size_t k = 0; k <= spectrum.size() / 2; ++k) {
      const double frequency =
          static_cast<double>(k) * kCompareRate / static_cast<double>(spectrum.size());
      const auto edge = std::upper_bound(edges.begin(), edges.end(), frequency);
      if (edge != edges.end())
        energy[static_cast<std::size_t>(edge - edges.begin()) - 1] += std::norm(spectrum[k]);
    }
  }
  return energy;
}

}  // namespace

std::vector<double> third_octaves() {
  constexpr int kBands = 22;
  std::vector<double> edges{0};
  for (int k = 0; k < kBands; ++k) edges.push_back(std::exp2(-2.5 + k / 3.0));
  return edges;
}

Place place_of(const Signal& signal, const Record& record) {
  const std::size_t samples = signal.size() / 2;
  const std::size_t stride = record.truth.size() / samples;
  std::vector<double> time(kTimeCells, 0);
  std::vector<double> state(kStateCells * kStateCells, 0);
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (std::size_t k = 0; k < samples; ++k) {
      const double energy = signal[axis * samples + k] * signal[axis * samples + k];
      const Boundary& now = record.truth[k * stride];
      time[k * kTimeCells / samples] += energy;
      state[cell_of(now.displacement[axis], kStateDisplacement) * kStateCells +
            cell_of(now.velocity[axis], kStateVelocity)] += energy;
    }
  return {placed(std::move(time)), placed(energy_in_frequency(signal, samples)),
          placed(std::move(state))};
}

}  // namespace trial
