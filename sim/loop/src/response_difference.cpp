// SPDX-License-Identifier: Apache-2.0
#include <rths/loop/response_difference.hpp>

#include <algorithm>
#include <cmath>

#include <rths/sim/floor_spectrum.hpp>

namespace rths::loop {
namespace {

constexpr double kLowestOfSpectra = 0.3, kDampingRatio = 0.05;  // [Hz], [-]
constexpr int kFrequencies = 80;

using Values = std::vector<double>;

double energy_of(const Values& values) {
  return Eigen::VectorXd::Map(values.data(), std::ssize(values)).squaredNorm();
}

double energy_between(const Values& a, const Values& b) {
  return (Eigen::VectorXd::Map(a.data(), std::ssize(a)) -
          Eigen::VectorXd::Map(b.data(), std::ssize(b)))
      .squaredNorm();
}

double largest_difference(const Values& found, const Values& reference) {
  double largest = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i] != reference[i])
      largest = std::max(largest, std::abs(found[i] - reference[i]) / reference[i]);
  return largest;
}

}  // namespace

double displacement_difference(const ResponseHistory& found, const ResponseHistory& reference) {
  const double difference = energy_between(found.displacement_long, reference.displacement_long) +
                            energy_between(found.displacement_lat, reference.displacement_lat);
  return std::sqrt(difference / (energy_of(reference.displacement_long) +
                                 energy_of(reference.displacement_lat)));
}

std::vector<SpectralDifference> spectral_differences(const ResponseHistory& found,
                                                     const ResponseHistory& reference) {
  const Values frequencies =
      sim::spectrum_frequencies(kLowestOfSpectra, kHighestOfSpectra, kFrequencies);
  const auto spectrum = [&](const Values& along, const Values& across) {
    return sim::floor_spectrum(along, across, reference.time_step, frequencies, kDampingRatio);
  };
  std::vector<SpectralDifference> differences;
  for (std::size_t i = 0; i < reference.floors.size(); ++i) {
    const auto &mine = found.floors[i], &theirs = reference.floors[i];
    differences.push_back(
        {largest_difference(spectrum(mine.acceleration_long, mine.acceleration_lat),
                            spectrum(theirs.acceleration_long, theirs.acceleration_lat)),
         0});
    if (theirs.acceleration_vert.empty()) continue;
    const Values none(theirs.acceleration_vert.size(), 0.0);
    differences.back().vertical = largest_difference(spectrum(mine.acceleration_vert, none),
                                                     spectrum(theirs.acceleration_vert, none));
  }
  return differences;
}

}  // namespace rths::loop
