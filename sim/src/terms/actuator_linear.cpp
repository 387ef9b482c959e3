// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

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

}  // namespace

std::span<const TermKind> linear_actuator_kinds() {
  return kinds_of<ActuatorDelay, ActuatorLag, ActuatorBandwidth, OilColumnResonance>();
}

}  // namespace rths::sim
