// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/sim/composition.hpp>

namespace rths::bench {

/// Inputs of a composition, one per step.
using Shaking = std::vector<sim::Quantities<double>>;

/// Times of single steps over all passes [ns].
struct StepTimes {
  double p50 = 0, p99 = 0, p999 = 0;
  double worst = 0;       ///< includes interrupts
  double worst_code = 0;  ///< largest of the steps' shortest times over the passes: the code alone
};

/// Times each step of each pass. Each pass begins with a new bearing.
/// @param tick  of `stamp` [ns]
[[nodiscard]] StepTimes step_times(const sim::Composition& composition, const Shaking& shaking,
                                   int passes, double tick);

/// Time of a step with four derivatives / without: median over passes [-].
[[nodiscard]] double dual_ratio(const sim::Composition& composition, const Shaking& shaking,
                                int passes, double tick);

/// Time of one bearing's step in a loop over many bearings: median over steps [ns].
[[nodiscard]] double loop_time(const sim::Composition& composition, const Shaking& shaking,
                               int bearings, double tick);

}  // namespace rths::bench
