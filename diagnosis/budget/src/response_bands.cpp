// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/response_bands.hpp>

#include <algorithm>
#include <cmath>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/core/side_by_side.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/sim/floor_spectrum.hpp>

namespace rths::budget {
namespace {

constexpr double kDampingRatio = 0.05;          // of floor spectra in nuclear practice
constexpr double kLowest = 0.2, kHighest = 33;  // [Hz], the band of nuclear practice
constexpr int kFrequencies = 80;
constexpr std::size_t kDraws = 8;  // of the remainder
constexpr std::size_t kPeaks = 4;  // displacement and force, long and lat

double peak_of(const std::vector<double>& values) {
  double peak = 0;
  for (const double value : values) peak = std::max(peak, std::abs(value));
  return peak;
}

// Peaks, then the spectra of all floors.
Eigen::VectorXd quantities_of(const loop::ResponseHistory& history,
                              const std::vector<double>& frequencies) {
  std::vector<double> all{peak_of(history.displacement_long), peak_of(history.displacement_lat),
                          peak_of(history.force_long), peak_of(history.force_lat)};
  for (const auto& floor : history.floors) {
    const auto spectrum = sim::floor_spectrum(floor.acceleration_long, floor.acceleration_lat,
                                              history.time_step, frequencies, kDampingRatio);
    all.insert(all.end(), spectrum.begin(), spectrum.end());
  }
  Eigen::VectorXd result = Eigen::Map<const Eigen::VectorXd>(all.data(), std::ssize(all));
  if (!result.allFinite()) throw Error{"the improved simulation diverges"};
  return result;
}

// The remainder from another instant on; it returns to its start after its end.
loop::AddedForce begun_later(const loop::AddedForce& remainder, std::size_t draw,
                             std::size_t steps) {
  const std::size_t length = remainder.size();
  const std::size_t begin = (2 * draw + 1) * length / (2 * kDraws);
  const double sign = draw % 2 == 0 ? 1 : -1;
  loop::AddedForce force(steps);
  for (std::size_t i = 0; i < steps; ++i) force[i] = sign * remainder[(begin + i) % length];
  return force;
}

ResponseBands bands_of(const Eigen::VectorXd& values, const Eigen::VectorXd& variances,
                       const std::vector<double>& frequencies,
                       const std::vector<std::string>& floors) {
  const Eigen::VectorXd half = maths::kNormal95 * variances.cwiseSqrt();
  const Eigen::VectorXd low = (values - half).cwiseMax(0), high = values + half;
  ResponseBands bands;
  bands.frequencies = frequencies;
  bands.damping_ratio = kDampingRatio;
  for (std::size_t i = 0; i < kPeaks; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const std::string axis = name_of(kHorizontal[i % 2]);
    bands.peaks.push_back({(i < 2 ? "displacement." : "force.") + axis, i < 2 ? "m" : "N",
                           values[at], low[at], high[at]});
  }
  for (std::size_t i = 0; i < floors.size(); ++i) {
    const auto part = [&](const Eigen::VectorXd& all) {
      const auto begin = all.begin() + static_cast<Eigen::Index>(kPeaks + i * frequencies.size());
      return std::vector<double>(begin, begin + std::ssize(frequencies));
    };
    bands.spectra.push_back({floors[i], part(values), part(low), part(high)});
  }
  return bands;
}

}  // namespace

ResponseBands response_bands(const UncertainSimulation& simulation) {
  const auto frequencies = sim::spectrum_frequencies(kLowest, kHighest, kFrequencies);
  const auto run = [&](const sim::Bearing& specimen, const loop::AddedForce& added) {
    return quantities_of(
        loop::numerical_response(*simulation.structure, simulation.motion, specimen,
                                 simulation.time_step, simulation.duration, added),
        frequencies);
  };
  const auto steps =
      static_cast<std::size_t>(std::lround(simulation.duration / simulation.time_step));
  const std::size_t deviating = simulation.deviating.size();
  const bool has_remainder = !simulation.remainder.empty();
  std::vector<Eigen::VectorXd> found(1 + deviating + (has_remainder ? kDraws : 0));
  side_by_side(found.size(), [&](std::size_t i) {
    if (i == 0)
      found[i] = run(simulation.fitted, {});
    else if (i <= deviating)
      found[i] = run(simulation.deviating[i - 1], {});
    else
      found[i] =
          run(simulation.fitted, begun_later(simulation.remainder, i - deviating - 1, steps));
  });
  const Eigen::VectorXd& fitted = found[0];
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(fitted.size());
  for (std::size_t i = 1; i < found.size(); ++i)
    variances += (found[i] - fitted).cwiseAbs2() *
                 (i <= deviating ? 0.5 : 1.0 / static_cast<double>(kDraws));
  ResponseBands bands = bands_of(fitted, variances, frequencies, simulation.structure->floors());
  bands.runs = static_cast<int>(found.size());
  bands.has_remainder = has_remainder;
  return bands;
}

}  // namespace rths::budget
