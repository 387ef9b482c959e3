// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <rths/sim/dual.hpp>

namespace rths::sim {

// Below this fraction of a time step, a lag is a shift along the line between two samples.
inline constexpr double kShortestLag = 1e-3;

/// T ẏ + y = r, solved exactly for r linear within a step. Starts at rest at the first r.
template <class Real>
struct FirstOrderLag {
  static constexpr std::size_t kStates = 3;  ///< started, r, y
  Real kept{}, shift{};

  FirstOrderLag(const Real& time_constant, double time_step) {
    const Real steps = time_constant * (1 / time_step);
    if (steps > kShortestLag) kept = exp(-1 / steps);
    shift = steps * (1 - kept);
  }
  Real operator()(Real* state, const Real& r) const {
    if (state[0] == 0) state[0] = 1.0, state[1] = state[2] = r;
    Real y = r - shift * (r - state[1]) + kept * (state[2] - state[1]);
    state[1] = r;
    return state[2] = y;
  }
};

/// T ẏ + y = r, solved exactly for r cubic through the last four samples. A lag shorter than a step
/// differs from a delay by less than from a lag of a signal that is linear within each step. Starts
/// at rest at the first r.
template <class Real>
struct SmoothLag {
  static constexpr std::size_t kStates = 5;  ///< r known, the last three, y
  Real kept{};
  std::array<Real, 4> gain{};  ///< of r and its differences backwards

  SmoothLag(const Real& time_constant, double time_step) {
    const Real steps = time_constant * (1 / time_step);
    if (steps > kShortestLag) kept = exp(-1 / steps);
    const std::array<Real, 4> m = steps < kLong ? moments(steps) : moments_of_long(steps);
    gain = {m[0], m[1], (m[1] + m[2]) * 0.5, (2 * m[1] + 3 * m[2] + m[3]) * (1.0 / 6)};
  }
  Real operator()(Real* state, const Real& r) const {
    Real *past = state + 1, &y = state[4];
    if (state[0] == 0) past[0] = past[1] = past[2] = y = r;
    const Real first = r - past[0], second = first - (past[0] - past[1]);
    const Real third = second - (past[0] - 2 * past[1] + past[2]);
    y = kept * y + gain[0] * r + gain[1] * first;
    if (state[0] > 1) y += gain[2] * second;
    if (state[0] > 2) y += gain[3] * third;
    if (state[0] < 3) state[0] += 1.0;
    past[2] = past[1], past[1] = past[0], past[0] = r;
    return y;
  }

 private:
  static constexpr double kLong = 10;  // steps: beyond, the recursion of the moments loses digits

  // ∫ xᵏ e^(x/s) dx/s over the step, -1 … 0, for k = 0 … 3.
  std::array<Real, 4> moments(const Real& s) const {
    std::array<Real, 4> m{1 - kept};
    m[1] = kept - s * m[0];
    m[2] = -kept - 2 * s * m[1];
    m[3] = kept - 3 * s * m[2];
    return m;
  }
  // The same by the series of the exponential.
  static std::array<Real, 4> moments_of_long(const Real& s) {
    constexpr int kTerms = 9;
    std::array<Real, 4> m{};
    Real factor = 1 / s;
    for (int j = 0; j < kTerms; ++j) {
      for (int k = 0; k < 4; ++k)
        m[static_cast<std::size_t>(k)] += factor * (((k + j) % 2 == 0 ? 1.0 : -1.0) / (k + j + 1));
      factor = factor * (1 / s) * (1.0 / (j + 1));
    }
    return m;
  }
};

/// T² ÿ + 2 ζ T ẏ + y = r, solved exactly for r linear within a step. Starts at rest at the first
/// r.
template <class Real>
struct SecondOrderLag {
  static constexpr std::size_t kStates = 4;  ///< started, r, y, Δt ẏ

  // Time in steps; coefficients of the free motion e'' = −a e − 2 b e' over one step.
  Real lag{};       ///< 2 ζ T
  Real ee{}, ed{};  ///< of e and e' in the next e
  Real de{}, dd{};  ///< of e and e' in the next e'
  SecondOrderLag(const Real& time_constant, const Real& damping, double time_step) {
    const Real steps = time_constant * (1 / time_step);
    lag = 2 * damping * steps;
    if (!(steps > kShortestLag)) return;
    const Real frequency = 1 / steps, decay = damping * frequency;
    Real c, s;
    free_motion(frequency, damping, c, s);
    ee = c + decay * s, ed = s;
    de = -(frequency * frequency) * s, dd = c - decay * s;
  }
  Real operator()(Real* state, const Real& r) const {
    if (state[0] == 0) state[0] = 1.0, state[1] = state[2] = r;
    const Real slope = r - state[1];
    const Real e = state[2] - state[1] + lag * slope, d = state[3] - slope;
    state[1] = r;
    state[3] = slope + de * e + dd * d;
    return state[2] = r - lag * slope + ee * e + ed * d;
  }

 private:
  // e^−ζω cos ω_d and e^−ζω sin ω_d / ω_d with ω_d² = (1 − ζ²) ω² of either sign.
  static void free_motion(const Real& frequency, const Real& damping, Real& c, Real& s) {
    const Real square = (1 - damping * damping) * frequency * frequency;
    const Real decay = damping * frequency;
    if (square > 1e-4) {
      const Real damped = sqrt(square), kept = exp(-decay);
      c = kept * cos(damped), s = kept * sin(damped) / damped;
    } else if (square < -1e-4) {
      const Real spread = sqrt(-square), slow = exp(spread - decay), fast = exp(-spread - decay);
      c = 0.5 * (slow + fast), s = 0.5 * (slow - fast) / spread;
    } else {  // series: the error is below square³/5040
      const Real kept = exp(-decay);
      c = kept * (1 - square * (0.5 - square * (1.0 / 24)));
      s = kept * (1 - square * (1.0 / 6 - square * (1.0 / 120)));
    }
  }
};

}  // namespace rths::sim
