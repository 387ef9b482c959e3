// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {

/// Compares the integration step of a script with that of the experiment, at its first moves.
class ScriptStep {
 public:
  /// @param expected  of the experiment; 0: any step is accepted [s]
  explicit ScriptStep(double expected) : expected_{expected}, is_checked_{expected == 0} {}

  /// Takes the time of a trial [s].
  void note(double time) {
    if (time == time_) return;
    is_first_ = time_ == 0;
    advance_ = time - time_;
    time_ = time;
  }
  /// Checks the last advance of the time, when a trial of the analysis moves the specimen. The
  /// first step ends at t + α·Δt with an α of at least a half, so only the second one is exact.
  /// @throws Error if the steps differ
  void check() {
    if (is_checked_ || advance_ == 0) return;
    const bool is_far = is_first_ && advance_ > kLongestOrigin * expected_;  // the time began later
    const double least = is_first_ ? kLeastAlpha * expected_ : expected_;
    const double tolerance = kTolerance * expected_;
    if (!is_far && (advance_ < least - tolerance || advance_ > expected_ + tolerance))
      throw Error{
          fmt::format("the script advances its time by {:.6g} s at its first move, "
                      "expected {:g} s (integration_step_s)",
                      advance_, expected_)};
    is_checked_ = !is_first_;
  }

 private:
  static constexpr double kLeastAlpha = 0.5;
  static constexpr double kTolerance = 1e-3;    // of a step
  static constexpr double kLongestOrigin = 20;  // steps
  double expected_, time_ = 0, advance_ = 0;
  bool is_first_ = false, is_checked_;
};

}  // namespace rths::adapters
