// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace rths::sim {

/// Exact step of ẍ + 2ζω ẋ + ω² x = −a(t) for a(t) linear over the step:
///     (x, ẋ)⁺ = A (x, ẋ) + B (a, a⁺)
struct OscillatorStep {
  double A[2][2], B[2][2];
  double omega, damping_ratio;
};

/// @param omega  undamped [rad/s]   @param zeta  damping ratio [-]   @param h  step [s]
inline OscillatorStep oscillator_step(double omega, double zeta, double h) {
  const double root = std::sqrt(1 - zeta * zeta);
  const double omega_d = omega * root;
  const double decay = std::exp(-zeta * omega * h);
  const double s = std::sin(omega_d * h);
  const double c = std::cos(omega_d * h);
  const double w2 = omega * omega;
  const double w3h = w2 * omega * h;
  const double z1 = (2 * zeta * zeta - 1) / (w2 * h);
  const double z2 = 2 * zeta / w3h;
  OscillatorStep step{};
  step.omega = omega;
  step.damping_ratio = zeta;
  step.A[0][0] = decay * (zeta / root * s + c);
  step.A[0][1] = decay * s / omega_d;
  step.A[1][0] = -omega / root * decay * s;
  step.A[1][1] = decay * (c - zeta / root * s);
  step.B[0][0] = decay * ((z1 + zeta / omega) * s / omega_d + (z2 + 1 / w2) * c) - z2;
  step.B[0][1] = -decay * (z1 * s / omega_d + z2 * c) - 1 / w2 + z2;
  const double dc = c - zeta / root * s;
  const double ds = omega_d * s + zeta * omega * c;
  step.B[1][0] = decay * ((z1 + zeta / omega) * dc - (z2 + 1 / w2) * ds) + 1 / (w2 * h);
  step.B[1][1] = -decay * (z1 * dc - z2 * ds) - 1 / (w2 * h);
  return step;
}

/// State: displacement relative to the support, and its rate [m], [m/s].
struct Oscillator {
  double x = 0, v = 0;

  /// @returns absolute acceleration at the end of the step [m/s²]   @realtime
  double advance(const OscillatorStep& step, double a0, double a1) noexcept {
    const double next_x =
        step.A[0][0] * x + step.A[0][1] * v + step.B[0][0] * a0 + step.B[0][1] * a1;
    v = step.A[1][0] * x + step.A[1][1] * v + step.B[1][0] * a0 + step.B[1][1] * a1;
    x = next_x;
    return -(2 * step.damping_ratio * step.omega * v + step.omega * step.omega * x);
  }
};

}  // namespace rths::sim
