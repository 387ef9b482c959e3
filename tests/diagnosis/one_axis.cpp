// SPDX-License-Identifier: Apache-2.0
#include "one_axis.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace rths::diagnosis::test_support {

Record record_of(const std::string& name, Use use, unsigned seed, const Specimen& specimen,
                 const Recorded& recorded) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  double phase[4], frequency[4];
  for (int i = 0; i < 4; ++i) {
    phase[i] = 2 * std::numbers::pi * uniform(random);
    frequency[i] = 0.25 * (i + 1) + 0.1 * uniform(random);
  }
  Record record;
  record.name = name;
  record.use = use;
  record.time_step = kStep;
  Channel u{"displacement.long", "m", {}}, f{"force.long", "N", {}};
  const int samples = static_cast<int>(recorded.length / kStep);
  for (int k = 0; k < samples; ++k) {
    const double t = k * kStep;
    const double rise = t < kQuiet ? 0 : 1 - std::exp(-std::pow((t - kQuiet) / 2, 2));
    const double slope =
        t < kQuiet ? 0 : (t - kQuiet) / 2 * std::exp(-std::pow((t - kQuiet) / 2, 2));
    double x = 0, v = 0;
    for (int i = 0; i < 4; ++i) {
      const double w = 2 * std::numbers::pi * frequency[i];
      x += 0.03 * rise * std::sin(w * t + phase[i]);
      v += 0.03 * (rise * w * std::cos(w * t + phase[i]) + slope * std::sin(w * t + phase[i]));
    }
    double force = specimen(t, x, v) + kForceNoise * normal(random) + 50;
    if (recorded.force_step > 0)
      force = recorded.force_step * std::round(force / recorded.force_step);
    u.values.push_back(x + 2e-7 * normal(random));
    f.values.push_back(force);
  }
  record.channels = {u, f};
  record.quiet = {0, static_cast<std::size_t>(kQuiet / kStep)};
  return record;
}

}  // namespace rths::diagnosis::test_support
