// SPDX-License-Identifier: Apache-2.0
//
// The noise of the sensors: what the identified laboratory leaves of the measured signals.
#include <algorithm>
#include <cmath>
#include <limits>

#include "platen.hpp"

namespace rths::budget {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kReach = 400;  // of the parabola that is no noise, samples

// The largest noise: a multiple of its standard deviation at rest. Unlimited without rest.
double limit_of(const std::vector<double>& noise, std::size_t at_rest) {
  constexpr std::size_t kFewest = 100;  // samples
  constexpr double kMostDeviations = 3;
  if (at_rest < kReach + kFewest || at_rest > noise.size())
    return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (std::size_t i = kReach; i < at_rest; ++i) sum += noise[i] * noise[i];
  return kMostDeviations * std::sqrt(sum / static_cast<double>(at_rest - kReach));
}

std::vector<double> noise_beside(const std::vector<double>& measured,
                                 const std::vector<double>& modelled, std::size_t at_rest) {
  std::vector<double> noise = measured;
  for (std::size_t i = 0; i < std::min(noise.size(), modelled.size()); ++i) noise[i] -= modelled[i];
  noise = noise_of(noise, kReach);
  const double most = limit_of(noise, at_rest);
  for (double& value : noise) value = std::clamp(value, -most, most);
  return noise;
}

}  // namespace

std::vector<double> noise_of(const std::vector<double>& signal, std::size_t reach) {
  std::vector<double> noise(signal.size(), 0.0);
  const auto m = static_cast<double>(reach);
  // Weights of the smoothing parabola at its middle.
  const double divisor = (2 * m - 1) * (2 * m + 1) * (2 * m + 3) / 3;
  for (std::size_t i = reach; i + reach < signal.size(); ++i) {
    double smooth = 0;
    for (std::size_t j = 0; j <= 2 * reach; ++j) {
      const double x = static_cast<double>(j) - m;
      smooth += (3 * m * m + 3 * m - 1 - 5 * x * x) / divisor * signal[i + j - reach];
    }
    noise[i] = signal[i] - smooth;
  }
  return noise;
}

std::array<MeasuredNoise, 2> sensor_noise(const HybridTest& test,
                                          const std::array<sim::TransferRecord, 2>& records) {
  platen::ServoTransfer laboratory{test, test.machine_identified, test.specimen_identified};
  platen::Sensors sensors{test.machine_identified, test.period};
  platen::Platen motion;
  std::array<MeasuredNoise, 2> modelled;
  const std::size_t ticks = std::max(records[0].reference.size(), records[1].reference.size());
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const double load = test.axial_load.empty()
                            ? test.specimen_identified.axial_load
                            : test.axial_load[std::min(tick, test.axial_load.size() - 1)];
    laboratory.step(
        {platen::at(records[0].reference, tick), platen::at(records[1].reference, tick)}, load,
        motion);
    const auto read =
        sensors(motion, laboratory.table_force, static_cast<double>(tick + 1) * test.period, load);
    for (Eigen::Index i = 0; i < 2; ++i) {
      auto& axis = modelled[static_cast<std::size_t>(i)];
      axis.displacement.push_back(read.displacement[i]);
      axis.acceleration.push_back(read.acceleration[i]);
      axis.force.push_back(read.force[i]);
    }
  }
  std::array<MeasuredNoise, 2> noise;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto beside = [&](const std::vector<double>& measured, const std::vector<double>& model) {
      return noise_beside(measured, model, test.host.first_target);
    };
    noise[i] = {beside(records[i].displacement, modelled[i].displacement),
                beside(records[i].acceleration, modelled[i].acceleration),
                beside(records[i].force, modelled[i].force)};
  }
  return noise;
}

}  // namespace rths::budget
