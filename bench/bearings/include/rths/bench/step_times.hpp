// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/sim/composition.hpp>

namespace rths::bench {

/// Inputs of a composition, step after step.
using Shaking = std::vector<sim::Quantities<double>>;

/// Of single steps, over all passes [ns].
struct StepTimes {
  double p50 = 0, p99 = 0, p999 = 0;
  double worst = 0;       ///< interrupts and all
  double worst_code = 0;  ///< of the steps, each at its quickest pass: what the code itself takes
};

/// Times each step of each pass. A pass begins with a bearing that nothing has happened to.
/// @param tick  of `stamp` [ns]
[[nodiscard]] StepTimes step_times(const sim::Composition& composition, const Shaking& shaking,
                                   int passes, double tick);

/// A step with four derivatives over one without: medians of whole passes [-].
[[nodiscard]] double dual_ratio(const sim::Composition& composition, const Shaking& shaking,
                                int passes, double tick);

/// Time of one bearing's step where many take theirs one after the other: median over steps [ns].
[[nodiscard]] double loop_time(const sim::Composition& composition, const Shaking& shaking,
                               int bearings, double tick);

}  // namespace rths::bench
