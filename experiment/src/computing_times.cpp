// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/computing_times.hpp>

#include <algorithm>

namespace rths::experiment {

double ComputingTimes::draw() noexcept {
  std::normal_distribution<double> normal{model_.mean, model_.spread * model_.mean};
  std::uniform_real_distribution<double> uniform{0, 1};
  const double usual = std::clamp(normal(random_), 0.0, 2 * model_.mean);
  return usual + (uniform(random_) < model_.overrun_fraction ? model_.overrun : 0);
}

}  // namespace rths::experiment
