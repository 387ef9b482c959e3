// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include <rths/sim/composition.hpp>

namespace rths::sim::test_support {

/// Usual time step of a Stepper [s].
inline constexpr double kStep = 1e-3;

/// A composition with its state, advanced step by step.
class Stepper {
 public:
  Stepper(const std::vector<TermSettings>& terms, double time_step)
      : composition_{terms, time_step}, state_(composition_.states()) {}

  Quantities<double> step(Quantities<double> q) {
    q.time = time_;
    time_ += composition_.time_step();
    composition_.advance(state_, q);
    return q;
  }
  /// One step to a displacement.
  Quantities<double> to(double along, double across = 0) {
    Quantities<double> q;
    q.displacement = {along, across};
    return step(q);
  }
  /// Moves along the long axis in equal steps. @returns the result of the last step
  Quantities<double> walk(double from, double to_along, int steps) {
    Quantities<double> last;
    for (int i = 1; i <= steps; ++i) last = to(from + (to_along - from) * i / steps);
    return last;
  }

 private:
  Composition composition_;
  std::vector<double> state_;
  double time_ = 0;
};

using Values = std::vector<std::pair<std::string, double>>;

/// A linear spring.
[[nodiscard]] inline TermSettings spring(double stiffness) {
  return {"bouc_wen", "", {{"post_yield_stiffness", stiffness}}};
}

}  // namespace rths::sim::test_support
