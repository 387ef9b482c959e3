// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include <rths/core/realtime.hpp>

namespace rths::controller {

/// The polynomials of a predictor-corrector, named after their data.
///
/// P: target history alone. D: continuous with the command displacement at the last branch switch.
/// DV: targets with velocities. DVA: targets with velocities and accelerations. The number is the
/// order.
enum class Polynomial { P0, P1, P2, P3, D1, D2, D3, DV, DVA };

[[nodiscard]] std::optional<Polynomial> polynomial_from_text(std::string_view name);
[[nodiscard]] const char* to_text(Polynomial polynomial) noexcept;

/// Frame of local time x. Predict: the newest target s₁ at x = 0, older ones at −1, −2, −3.
/// Correct: s₁ at x = 1, older ones at 0, −1, −2, the command s_X at x = ξ.
enum class Branch { Predict, Correct };

/// A value with its first and second derivative in x (forward differentiation).
struct Jet {
  double value = 0, slope = 0, curvature = 0;

  friend constexpr Jet operator+(Jet a, Jet b) {
    return {a.value + b.value, a.slope + b.slope, a.curvature + b.curvature};
  }
  friend constexpr Jet operator-(Jet a, Jet b) {
    return {a.value - b.value, a.slope - b.slope, a.curvature - b.curvature};
  }
  friend constexpr Jet operator*(Jet a, Jet b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope,
            a.curvature * b.value + 2 * a.slope * b.slope + a.value * b.curvature};
  }
  friend constexpr Jet operator+(double a, Jet b) { return Jet{a, 0, 0} + b; }
  friend constexpr Jet operator-(double a, Jet b) { return Jet{a, 0, 0} - b; }
  friend constexpr Jet operator+(Jet a, double b) { return a + Jet{b, 0, 0}; }
  friend constexpr Jet operator-(Jet a, double b) { return a - Jet{b, 0, 0}; }
  friend constexpr Jet operator*(double a, Jet b) { return Jet{a, 0, 0} * b; }
  friend constexpr Jet operator*(Jet a, double b) { return b * a; }
  friend constexpr Jet operator/(Jet a, double b) { return (1 / b) * a; }
};

/// Weight of each known quantity in the command, in its rate and in its second rate.
///
///     command(x) = Σ target[i]·s_{i+1} + switch_command·s_X + Σ velocity[i]·v_{i+1}
///                  + acceleration·a₁
///
/// v and a are per step: velocity times the step's duration, acceleration times its square.
struct Weights {
  std::array<Jet, 4> target{};
  Jet switch_command{};
  std::array<Jet, 2> velocity{};
  Jet acceleration{};
};

/// Weights of a polynomial at local time x.
/// @param x   elapsed fraction of the step [-]
/// @param xi  local time of the last branch switch, 0 ≤ ξ < 1 when correcting, 0 < ξ ≤ 1 when
///            predicting [-]. As ξ → 1 a corrector's weights grow like 1/(1 − ξ).   @realtime
[[nodiscard]] Weights weights(Polynomial polynomial, Branch branch, double x,
                              double xi) RTHS_REALTIME;

}  // namespace rths::controller
