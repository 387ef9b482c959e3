// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <limits>

#include "compliance.hpp"
#include "delay_line.hpp"
#include "kinds.hpp"
#include "lag.hpp"

namespace rths::sim {
namespace {

// Linear terms act on displacement, velocity and acceleration alike.
constexpr std::size_t kMotionSignals = 3;  // displacement, velocity, acceleration
constexpr std::size_t kSignals = kHorizontalAxes * kMotionSignals;

template <class Real>
std::array<Real*, kMotionSignals> motion_of(Quantities<Real>& q, std::size_t axis) {
  return {&q.displacement[axis], &q.velocity[axis], &q.acceleration[axis]};
}

template <class Lag, class Real>
void lag_motion(const TermView<Real>& term, Quantities<Real>& q, const Lag& lag) {
  for_each_active_axis(term, [&](std::size_t axis) {
    Real* state = term.state + axis * kMotionSignals * Lag::kStates;
    for (Real* signal : motion_of(q, axis)) {
      *signal = lag(state, *signal);
      state += Lag::kStates;
    }
  });
}

struct ActuatorDelay : Acts<Stage::Actuator, kPerAxis | kDelaysCommand> {
  static constexpr Text kName = "actuator_delay";
  static constexpr Text kTitle = "pure delay of the actuator";
  static constexpr Text kEquation = "u(t) = command(t - tau)";
  static constexpr Text kSource = "Horiuchi et al. 1999; cubic interpolation is ours";
  enum { kDelay };
  static constexpr double kLongest = 0.2;  // [s]
  static constexpr Parameter kParameters[] = {{"delay", "s", 0, kLongest, 0, 12e-3}};

  static TermSize size(const TermSetup& setup) {
    using Line = DelayLine<double>;
    return {Line::states(Line::capacity(kLongest, setup.time_step), kSignals), 0};
  }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    DelayLine<Real> line{term.state, DelayLine<Real>::capacity(kLongest, term.time_step)};
    line.advance(term.parameters[kDelay] * (1 / term.time_step));
    for_each_active_axis(term, [&](std::size_t axis) {
      std::size_t signal = axis * kMotionSignals;
      for (Real* value : motion_of(q, axis)) *value = line.exchange(signal++, *value);
    });
  }
};

struct ActuatorLag : Acts<Stage::Actuator, kPerAxis> {
  static constexpr Text kName = "first_order_lag";
  static constexpr Text kTitle = "first-order lag of the actuator";
  static constexpr Text kEquation = "T u' + u = command";
  static constexpr Text kSource = "textbook, exact for a command linear in each step";
  enum { kTimeConstant };
  static constexpr Parameter kParameters[] = {{"time_constant", "s", 0, 10, 0, 20e-3}};
  static constexpr std::size_t kStates = kSignals * FirstOrderLag<double>::kStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    lag_motion(term, q, FirstOrderLag<Real>{term.parameters[kTimeConstant], term.time_step});
  }
};

struct SecondOrderActuator : Acts<Stage::Actuator, kPerAxis> {
  enum { kTimeConstant, kDamping };
  static constexpr std::size_t kStates = kSignals * SecondOrderLag<double>::kStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    lag_motion(term, q,
               SecondOrderLag<Real>{term.parameters[kTimeConstant], term.parameters[kDamping],
                                    term.time_step});
  }
};

// With the dead band of a valve and the velocity limit of a piston.
struct ActuatorBandwidth : Acts<Stage::Actuator, kPerAxis> {
  static constexpr Text kName = "actuator_bandwidth";
  static constexpr Text kTitle = "second-order lag of the actuator";
  static constexpr Text kEquation =
      "T^2 u'' + 2 zeta T u' = e - clip(e, d),  e = command - u,  |u'| <= v,  T = 1/(2 pi f)";
  static constexpr Text kSource =
      "Merritt 1967; exact for a command linear in each step within the limits";
  enum { kTimeConstant, kDamping, kDeadBand, kVelocityLimit };
  static constexpr double kUnlimited = 1e6;  // [m/s]
  static constexpr Parameter kParameters[] = {
      {"time_constant", "s", 0, 1, 0, 13e-3},
      {"damping", "-", 0.01, 10, 0.8, 0.8},
      {"dead_band", "m", 0, 10, 0, 1e-3},
      {"velocity_limit", "m/s", 1e-6, kUnlimited, kUnlimited, 1}};
  static constexpr std::size_t kStates = kSignals * SecondOrderLag<double>::kStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const SecondOrderLag<Real> lag{term.parameters[kTimeConstant], term.parameters[kDamping],
                                   term.time_step};
    const bool is_linear = is_just(term.parameters[kDeadBand], 0) &&
                           is_just(term.parameters[kVelocityLimit], kUnlimited);
    if (is_linear || !(term.parameters[kTimeConstant] > kShortestLag * term.time_step))
      return lag_motion(term, q, lag);
    for_each_active_axis(term, [&](std::size_t axis) {
      servo(term, lag, q, axis,
            term.state + axis * kMotionSignals * SecondOrderLag<double>::kStates);
    });
  }

 private:
  // The command reduced by the dead band. At the end of the step the reduction depends on u there,
  // which two iterations find.
  template <class Real>
  static void servo(const TermView<Real>& term, const SecondOrderLag<Real>& lag,
                    Quantities<Real>& q, std::size_t axis, Real* state) {
    const Real& band = term.parameters[kDeadBand];
    const auto seen = [&](const Real& command, const Real& u) {
      const Real e = command - u;
      if (e > band) return Real{command - band};
      if (e < -band) return Real{command + band};
      return u;
    };
    constexpr std::size_t kLagStates = SecondOrderLag<double>::kStates;
    const Real command = q.displacement[axis];
    if (state[0] == 0) lag(state, command);
    std::array<Real, kLagStates> start, end;
    std::copy_n(state, kLagStates, start.begin());
    Real u = start[2] + start[3];
    constexpr int kIterations = 2;
    for (int i = 0; i < kIterations; ++i) {
      end = start;
      u = lag(end.data(), seen(command, u));
    }
    const Real most = term.parameters[kVelocityLimit] * term.time_step;  // in a step
    if (end[3] > most || end[3] < -most) {
      end[3] = end[3] > 0 ? most : -most;
      u = end[2] = start[2] + 0.5 * (start[3] + end[3]);
    }
    end[1] = seen(command, u);
    std::copy_n(end.begin(), kLagStates, state);
    q.displacement[axis] = u;
    q.velocity[axis] = end[3] * (1 / term.time_step);
    q.acceleration[axis] = (end[3] - start[3]) * (1 / (term.time_step * term.time_step));
  }
};

struct OilColumnResonance : SecondOrderActuator {
  static constexpr Text kName = "oil_column_resonance";
  static constexpr Text kTitle = "oil-column resonance of the platen";
  static constexpr Text kEquation = "T^2 u'' + 2 zeta T u' + u = command,  T^2 = m V / (4 B A^2)";
  static constexpr Text kSource = "Merritt 1967, chapter 6";
  static constexpr Parameter kParameters[] = {{"time_constant", "s", 0, 1, 0, 13e-3},
                                              {"damping", "-", 0.001, 10, 0.1, 0.1}};
};

struct RateSaturation : Acts<Stage::Actuator, kPerAxis> {
  static constexpr Text kName = "rate_saturation";
  static constexpr Text kTitle = "velocity limit of the actuator";
  static constexpr Text kEquation = "u follows the command with |u'| <= v_max";
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

  static void step(const auto& term, auto& q) {
    const auto steps = term.parameters[kTimeConstant] * (1 / term.time_step);
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

std::span<const TermKind> actuator_kinds() {
  return kinds_of<ActuatorDelay, ActuatorLag, ActuatorBandwidth, OilColumnResonance, RateSaturation,
                  ValveDeadband, LoadCompliance>();
}

}  // namespace rths::sim
