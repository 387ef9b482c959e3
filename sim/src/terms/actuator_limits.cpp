// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "compliance.hpp"
#include "kinds.hpp"
#include "lag.hpp"

namespace rths::sim {
namespace {

struct RateSaturation : Acts<Stage::Actuator, kPerAxis> {
  static constexpr Text kName = "rate_saturation";
  static constexpr Text kTitle = "velocity limit of the actuator";
  static constexpr Text kEquation = "u follows the command with |u'| <= v_max";
  static constexpr Text kSource = "textbook";
  enum { kRate };
  static constexpr Parameter kParameters[] = {{"velocity_limit", "m/s", 1e-6, 1e3, 1e3, 0.3}};
  static constexpr std::size_t kStates = std::size_t{2} * kHorizontalAxes;  // started, u

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      Real* state = term.state + 2 * axis;
      const Real& command = q.displacement[axis];
      if (state[0] == 0) state[0] = 1.0, state[1] = command;
      const Real reach = term.parameters[kRate] * term.time_step;
      const Real missing = command - state[1];
      const Real move = clipped(missing, reach);
      if (move == missing) {
        state[1] = command;
        return;
      }
      state[1] += move;
      q.displacement[axis] = state[1];
      q.velocity[axis] = move * (1 / term.time_step);
      q.acceleration[axis] = Real{0};
    });
  }
};

// T u' = e − clip(e, d), e = command − u. Outside the dead band, the excess x = e ∓ d obeys
// x' = s − x/T with the command's velocity s, solved exactly; inside, u rests. In a step that
// leaves the band, only the time after the edge counts.
struct ValveDeadband : Acts<Stage::Actuator, kPerAxis> {
  static constexpr Text kName = "valve_deadband";
  static constexpr Text kTitle = "dead band of the servo valve";
  static constexpr Text kEquation = "T u' = e - clip(e, d),  e = command - u";
  static constexpr Text kSource = "Merritt 1967, chapter 5, in a position loop";
  enum { kBand, kTimeConstant };
  static constexpr Parameter kParameters[] = {{"dead_band", "m", 0, 10, 0, 1e-3},
                                              {"time_constant", "s", 0, 10, 0, 20e-3}};
  static constexpr std::size_t kAxisStates = 4;  // started, command, u, u'
  static constexpr std::size_t kStates = kHorizontalAxes * kAxisStates;

  // `rest`: error beyond the edge. `drive`: the share of it that drives u; 0 if the error has
  // returned across the edge within this step.
  template <class Real>
  struct Beyond {
    Real rest{}, drive{};
  };

  // After a step in which the error would change from `before` to `error` if u rested.
  template <class Real>
  static Beyond<Real> beyond(const Real& before, const Real& error, const Real& edge,
                             const Real& steps, bool came) {
    // Without a lag the edge of the band pushes u directly.
    if (!(steps > kShortestLag)) return {};
    const Real slope = error - before;
    const Real first = came ? Real{0} : Real{before - edge};
    const Real fraction = came ? Real{(error - edge) / slope} : Real{1};
    const Real kept = exp(-fraction / steps);
    const Real x = first * kept + steps * slope * (1 - kept);
    const bool crossed = (first > 0 && x < 0) || (first < 0 && x > 0);
    if (!crossed) return {x, x};
    return {slope * (1 - steps * log1p(-first / (steps * slope))), Real{0}};
  }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real steps = term.parameters[kTimeConstant] * (1 / term.time_step);
    for_each_active_axis(term, [&](std::size_t axis) { step_axis(term, q, axis, steps); });
  }

  template <class Real>
  static void step_axis(const TermView<Real>& term, Quantities<Real>& q, std::size_t axis,
                        const Real& steps) {
    const Real& band = term.parameters[kBand];
    const auto inside = [&](const Real& e) { return e <= band && e >= -band; };
    Real* state = term.state + axis * kAxisStates;
    const Real command = q.displacement[axis];
    if (state[0] == 0) state[0] = 1.0, state[1] = state[2] = command;
    const Real before = state[1] - state[2], error = command - state[2];  // if u rests
    state[1] = command;
    const bool came = inside(before) || !(steps > kShortestLag);
    if (came && inside(error)) {
      q.displacement[axis] = state[2];
      if (band > 0) set_velocity(term, q, axis, Real{0});
      return;
    }
    const Real edge = (came ? error : before) > 0 ? band : -band;
    const Beyond<Real> x = beyond(before, error, edge, steps, came);
    q.displacement[axis] = state[2] = command - edge - x.rest;
    if (steps > kShortestLag)
      set_velocity(term, q, axis, Real{x.drive / term.parameters[kTimeConstant]});
    else
      state[3] = q.velocity[axis];
  }

  // Mean acceleration over the step, because the acceleration jumps at the edges of the band.
  template <class Real>
  static void set_velocity(const TermView<Real>& term, Quantities<Real>& q, std::size_t axis,
                           const Real& velocity) {
    Real& last = term.state[axis * kAxisStates + 3];
    q.velocity[axis] = velocity;
    q.acceleration[axis] = (velocity - last) * (1 / term.time_step);
    last = velocity;
  }
};

struct LoadCompliance : Acts<Stage::Actuator, kPerAxis> {
  static constexpr Text kName = "load_compliance";
  static constexpr Text kTitle = "compliance of the actuator under load";
  static constexpr Text kEquation = "u = command - chi f,  T^2 f'' + 2 T f' + f = F";
  static constexpr Text kSource = "textbook; solution: docs/theory/machine_terms.md";
  enum { kCompliance, kStiffness, kTimeConstant };
  static constexpr Parameter kParameters[] = {{"compliance", "m/N", 0, 1e3, 0, 2e-9},
                                              kStiffnessEstimate,
                                              {"time_constant", "s", 0, 1, 0, 3e-3}};
  // Lag, compliance, deflection and its rate. The deflection changes displacement and acceleration,
  // but not the velocity, which keeps the specimen stable (compliance.hpp).
  static constexpr std::size_t kLagStates = SecondOrderLag<double>::kStates;
  static constexpr std::size_t kAxisStates = kLagStates + Compliance<double>::kStates + 2;
  static constexpr std::size_t kStates = kHorizontalAxes * kAxisStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const SecondOrderLag<Real> lag{term.parameters[kTimeConstant], Real{1}, term.time_step};
    for_each_active_axis(term, [&](std::size_t axis) {
      Real* state = term.state + axis * kAxisStates + kLagStates;
      Compliance<Real> oil{state, term.parameters[kCompliance], term.parameters[kStiffness]};
      const Real force = lag(state - kLagStates, q.last_specimen_force[axis]);
      const Real x =
          oil.yield(q.displacement[axis], force, Real{std::numeric_limits<double>::max()});
      const Real yield = q.displacement[axis] - x;
      const Real rate = (yield - state[2]) * (1 / term.time_step);
      q.acceleration[axis] -= (rate - state[3]) * (1 / term.time_step);
      q.displacement[axis] -= yield;
      state[2] = yield;
      state[3] = rate;
    });
  }
};

}  // namespace

std::span<const TermKind> actuator_limit_kinds() {
  return kinds_of<RateSaturation, ValveDeadband, LoadCompliance>();
}

}  // namespace rths::sim
