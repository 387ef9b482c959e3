// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include <rths/core/realtime.hpp>
#include <rths/experiment/parts.hpp>

namespace rths::experiment {

/// Seeded computing times of a solver, one per step.
class ComputingTimes {
 public:
  explicit ComputingTimes(const ComputingTime& model) : model_{model}, random_{model.seed} {}
  /// Computing time of the next step [s].   @realtime
  [[nodiscard]] double draw() RTHS_REALTIME;

 private:
  ComputingTime model_;
  std::mt19937_64 random_;
};

}  // namespace rths::experiment
