// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
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
    using std::exp;
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
    using std::cos;
    using std::exp;
    using std::sin;
    using std::sqrt;
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
