// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/floor_spectrum.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rths/core/error.hpp>
#include <rths/sim/oscillator.hpp>

namespace rths::sim {
namespace {

// A peak between two points of a sine is underestimated by at most 1 − cos(π/20), 1.2 %.
constexpr double kSubstepsPerPeriod = 20;

// Linear interpolation from sample i − 1 to sample i.
double between(std::span<const double> values, std::size_t i, int substep, int substeps) {
  return values[i - 1] + (values[i] - values[i - 1]) * substep / substeps;
}

}  // namespace

std::vector<double> spectrum_frequencies(double lowest, double highest, int count) {
  std::vector<double> frequencies;
  for (int i = 0; i < count; ++i)
    frequencies.push_back(lowest *
                          std::pow(highest / lowest, static_cast<double>(i) / (count - 1)));
  return frequencies;
}

std::vector<double> floor_spectrum(std::span<const double> long_acceleration,
                                   std::span<const double> lat_acceleration, double time_step,
                                   std::span<const double> frequencies, double damping_ratio) {
  if (long_acceleration.size() != lat_acceleration.size())
    throw Error{"floor spectrum: the two directions differ in length"};
  std::vector<double> spectrum;
  for (const double frequency : frequencies) {
    const int substeps = static_cast<int>(std::ceil(kSubstepsPerPeriod * frequency * time_step));
    const auto step =
        oscillator_step(2 * std::numbers::pi * frequency, damping_ratio, time_step / substeps);
    Oscillator along;
    Oscillator across;
    double peak_square = 0;
    for (std::size_t i = 1; i < long_acceleration.size(); ++i)
      for (int k = 0; k < substeps; ++k) {
        const double a = along.advance(step, between(long_acceleration, i, k, substeps),
                                       between(long_acceleration, i, k + 1, substeps));
        const double b = across.advance(step, between(lat_acceleration, i, k, substeps),
                                        between(lat_acceleration, i, k + 1, substeps));
        peak_square = std::max(peak_square, a * a + b * b);
      }
    spectrum.push_back(std::sqrt(peak_square));
  }
  return spectrum;
}

}  // namespace rths::sim
