// SPDX-License-Identifier: Apache-2.0
// Devices whose resistance is controlled while they move: magnetorheological dampers.
#include "delay_line.hpp"
#include "hysteresis.hpp"
#include "kinds.hpp"
#include "lag.hpp"
#include "presliding.hpp"

namespace rths::sim {
namespace {

// c_0 + c_1 I + c_2 I², at least 0. Exactly at 0 the derivatives are kept.
template <class Real>
Real level_of(const Real* coefficients, const Real& current) {
  const Real level = coefficients[0] + current * (coefficients[1] + current * coefficients[2]);
  return level < 0 ? Real{0} : level;
}

struct CurrentDependentFriction : Acts<Stage::Restoring, kPerAxis | kControlled> {
  static constexpr Text kName = "current_dependent_friction";
  static constexpr Text kTitle = "current-controlled friction of a damper";
  static constexpr Text kEquation =
      "F = max(0, F_0 + F_1 I + F_2 I^2) s |v|/(|v| + v_c),  ds = (du - s |du|) / z_s";
  static constexpr Text kSource = "Dahl 1968, exponent 1; polynomial and creep are ours";
  enum { kForce, kPerCurrent, kPerSquare, kPresliding, kCreep };
  static constexpr Parameter kParameters[] = {{"friction_force", "N", 0, 1e9, 0, 1e4},
                                              {"force_per_current", "N/A", -1e12, 1e12, 0, 2e4},
                                              {"force_per_current2", "N/A2", -1e12, 1e12, 0, 5e3},
                                              kPreslidingLength,
                                              {"creep_velocity", "m/s", 1e-9, 100, 1e-6, 5e-3}};
  static constexpr std::size_t kStates = kDahlStates;

  static void step(const auto& term, auto& q) {
    const auto level = level_of(term.parameters + kForce, q.auxiliary) * q.strength;
    for_each_active_axis(term, [&](std::size_t axis) {
      const auto speed = abs(q.velocity[axis]);
      const auto force = level * presliding(term, q, axis, term.parameters[kPresliding]) *
                         (speed / (speed + term.parameters[kCreep]));
      q.hysteretic_force[axis] += force;
      q.force[axis] += force;
    });
  }
};

struct CurrentDependentDamping
    : Acts<Stage::Restoring, kDissipative | kFrameIndifferent | kPerAxis | kControlled> {
  static constexpr Text kName = "current_dependent_damping";
  static constexpr Text kTitle = "current-controlled viscosity of a damper";
  static constexpr Text kEquation = "F = max(0, c_0 + c_1 I + c_2 I^2) v";
  static constexpr Text kSource = "textbook; the polynomial is ours";
  enum { kCoefficient, kPerCurrent, kPerSquare };
  static constexpr Parameter kParameters[] = {
      {"coefficient", "N*s/m", 0, 1e13, 0, 2e4},
      {"coefficient_per_current", "N*s/m/A", -1e13, 1e13, 0, 4e4},
      {"coefficient_per_current2", "N*s/m/A2", -1e13, 1e13, 0, 1e4}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return level_of(term.parameters + kCoefficient, q.auxiliary) * q.velocity[axis];
  }
};

// The coil and its amplifier: the field follows the recorded voltage or set current.
struct ControlLag : Acts<Stage::Modifier, kControlled> {
  static constexpr Text kName = "control_lag";
  static constexpr Text kTitle = "first-order lag of a device's control input";
  static constexpr Text kEquation = "T I' + I = recorded input";
  static constexpr Text kSource =
      "Spencer, Dyke, Sain & Carlson 1997; exact for an input linear in each step";
  enum { kTimeConstant };
  static constexpr Parameter kParameters[] = {{"time_constant", "s", 0, 10, 0, 20e-3}};
  static constexpr std::size_t kStates = FirstOrderLag<double>::kStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const FirstOrderLag<Real> lag{term.parameters[kTimeConstant], term.time_step};
    q.auxiliary = lag(term.state, q.auxiliary);
  }
};

struct ControlDelay : Acts<Stage::Modifier, kControlled> {
  static constexpr Text kName = "control_delay";
  static constexpr Text kTitle = "pure delay of a device's control input";
  static constexpr Text kEquation = "I(t) = recorded input(t - tau)";
  static constexpr Text kSource = "textbook; cubic interpolation is ours";
  enum { kDelay };
  static constexpr double kLongest = 0.2;  // [s]
  static constexpr Parameter kParameters[] = {{"delay", "s", 0, kLongest, 0, 12e-3}};

  static TermSize size(const TermSetup& setup) {
    using Line = DelayLine<double>;
    return {Line::states(Line::capacity(kLongest, setup.time_step), 1), 0};
  }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    DelayLine<Real> line{term.state, DelayLine<Real>::capacity(kLongest, term.time_step)};
    line.advance(term.parameters[kDelay] * (1 / term.time_step));
    q.auxiliary = line.exchange(0, q.auxiliary);
  }
};

}  // namespace

std::span<const TermKind> controlled_kinds() {
  return kinds_of<ControlLag, ControlDelay, CurrentDependentFriction, CurrentDependentDamping>();
}

}  // namespace rths::sim
