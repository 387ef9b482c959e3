// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <rths/sim/tables.hpp>

#include "kinds.hpp"

namespace rths::sim {
namespace {

struct LinearStiffness : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "linear_stiffness";
  static constexpr Text kTitle = "linear spring";
  static constexpr Text kEquation = "F = f k u,  f: stiffness factor of modifiers";
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m", -1e15, 1e15, 0, 4e6}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return q.stiffness * term.parameters[0] * q.displacement[axis];
  }
};

struct PolynomialStiffness : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "polynomial_stiffness";
  static constexpr Text kTitle = "polynomial spring";
  static constexpr Text kEquation =
      "F = f (k_1 u + k_2 u^2 + k_3 u^3),  f: stiffness factor of modifiers";
  enum { kLinear, kQuadratic, kCubic };
  static constexpr Parameter kParameters[] = {{"linear", "N/m", -1e15, 1e15, 0, 4e6},
                                              {"quadratic", "N/m2", -1e18, 1e18, 0, 5e6},
                                              {"cubic", "N/m3", -1e20, 1e20, 0, 1e8}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto* k = term.parameters;
    const auto& u = q.displacement[axis];
    return q.stiffness * u * (k[kLinear] + u * (k[kQuadratic] + u * k[kCubic]));
  }
};

struct PiecewiseStiffness : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "piecewise_stiffness";
  static constexpr Text kTitle = "piecewise-linear spring";
  static constexpr Text kEquation = "F = k_1 clip(u, u_b) + k_2 (u - clip(u, u_b))";
  enum { kInside, kOutside, kBreak };
  static constexpr Parameter kParameters[] = {{"inside_stiffness", "N/m", 0, 1e15, 0, 4e6},
                                              {"outside_stiffness", "N/m", 0, 1e15, 0, 1e7},
                                              {"break_displacement", "m", 0, 10, 0.05, 0.05}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto inside = clipped(q.displacement[axis], term.parameters[kBreak]);
    return term.parameters[kInside] * inside +
           term.parameters[kOutside] * (q.displacement[axis] - inside);
  }
};

struct PiecewiseDamping : Acts<Stage::Restoring, kDissipative | kPerAxis> {
  static constexpr Text kName = "piecewise_damping";
  static constexpr Text kTitle = "piecewise-linear damper";
  static constexpr Text kEquation = "F = c_1 clip(v, v_b) + c_2 (v - clip(v, v_b))";
  enum { kSlow, kFast, kBreak };
  static constexpr Parameter kParameters[] = {{"slow_coefficient", "N*s/m", 0, 1e13, 0, 2e5},
                                              {"fast_coefficient", "N*s/m", 0, 1e13, 0, 5e4},
                                              {"break_velocity", "m/s", 0, 100, 0.1, 0.1}};

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto slow = clipped(q.velocity[axis], term.parameters[kBreak]);
    return term.parameters[kSlow] * slow + term.parameters[kFast] * (q.velocity[axis] - slow);
  }
};

struct GapContact : Acts<Stage::Restoring, kDissipative | kPerAxis> {
  static constexpr Text kName = "gap_contact";
  static constexpr Text kTitle = "stop behind a gap, with impact damping";
  static constexpr Text kEquation = "F = sgn(u) max(0, k d (1 + c d')),  d = max(0, |u| - gap)";
  static constexpr Text kSource = "Hunt & Crossley 1975, exponent 1";
  enum { kGap, kStiffness, kLoss };
  static constexpr Parameter kParameters[] = {{"gap", "m", 0, 10, 0.1, 0.1},
                                              {"stiffness", "N/m", 0, 1e15, 0, 5e7},
                                              {"loss", "s/m", 0, 100, 0, 0.5}};

  static void step(const auto& term, auto& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      const double side = value_of(q.displacement[axis]) < 0 ? -1 : 1;
      const auto depth = abs(q.displacement[axis]) - term.parameters[kGap];
      const auto hold = 1 + term.parameters[kLoss] * q.velocity[axis] * side;
      if (depth > 0 && hold > 0) q.force[axis] += term.parameters[kStiffness] * depth * hold * side;
    });
  }
};

// Laws given by values at knots: of devices that were measured, and of effects without a name.
constexpr std::size_t kKnots = kEvenKnots.size();

// The value between knots, linear; beyond the outer knots, constant. `table`: the range of x, then
// the values at the knots.
template <class Real>
Real interpolated(const Real* table, const std::array<double, kKnots>& knots, const Real& at) {
  const Real* values = table + 1;
  const Real x = at / table[0];
  if (x <= knots[0]) return values[0];
  for (std::size_t i = 1; i < kKnots; ++i)
    if (x <= knots[i]) {
      const Real share = (x - knots[i - 1]) * (1 / (knots[i] - knots[i - 1]));
      return values[i - 1] + share * (values[i] - values[i - 1]);
    }
  return values[kKnots - 1];
}

// The range, then the values at the knots.
constexpr std::array<Parameter, kKnots + 1> table_of(std::string_view axis, double most,
                                                     std::string_view value) {
  constexpr std::string_view kNames[] = {"value_1", "value_2", "value_3", "value_4", "value_5",
                                         "value_6", "value_7", "value_8", "value_9"};
  std::array<Parameter, kKnots + 1> parameters{};
  parameters[0] = {"range", axis, 1e-9, most, 0.1, 0.1};
  for (std::size_t i = 0; i < kKnots; ++i)
    parameters[i + 1] = {kNames[i], value, -1e12, 1e12, 0, kEvenKnots[i] * 1e5 + 1e3};
  return parameters;
}
constexpr auto kForceOverDisplacement = table_of("m", 10, "N");
constexpr auto kForceOverVelocity = table_of("m/s", 1000, "N");
constexpr auto kCoefficientOverDisplacement = table_of("m", 10, "N*s/m");

struct TabulatedSpring : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "tabulated_stiffness";
  static constexpr Text kTitle = "force given by a table of the displacement";
  static constexpr Text kEquation =
      "F = f(u), linear between 9 knots at -1, -3/4 ... 1 times the range, constant beyond";
  static constexpr auto& kParameters = kForceOverDisplacement;

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return interpolated(term.parameters, kEvenKnots, q.displacement[axis]);
  }
};

struct TabulatedDamper : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "tabulated_damping";
  static constexpr Text kTitle = "force given by a table of the velocity";
  static constexpr Text kEquation =
      "F = f(v), linear between 9 knots at 0, ±0.05, ±0.2, ±0.5, ±1 times the range, constant "
      "beyond";
  static constexpr auto& kParameters = kForceOverVelocity;

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return interpolated(term.parameters, kDenseKnots, q.velocity[axis]);
  }
};

struct TabulatedFriction : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "tabulated_friction";
  static constexpr Text kTitle = "friction given by a table of the displacement";
  static constexpr Text kEquation =
      "F = g(u) tanh(v / v_0), g linear between 9 knots at -1, -3/4 ... 1 times the range, "
      "constant beyond";
  static constexpr auto kParameters = [] {
    std::array<Parameter, kKnots + 2> parameters{};
    for (std::size_t i = 0; i <= kKnots; ++i) parameters[i] = kForceOverDisplacement[i];
    parameters[kKnots + 1] = {"creep_velocity", "m/s", 1e-9, 100, 1e-3, 1e-3};
    return parameters;
  }();

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    const auto direction = tanh(q.velocity[axis] / term.parameters[kKnots + 1]);
    return direction * interpolated(term.parameters, kEvenKnots, q.displacement[axis]);
  }
};

struct TabulatedViscosity : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "tabulated_viscosity";
  static constexpr Text kTitle = "viscosity given by a table of the displacement";
  static constexpr Text kEquation =
      "F = c(u) v, c linear between 9 knots at -1, -3/4 ... 1 times the range, constant beyond";
  static constexpr auto& kParameters = kCoefficientOverDisplacement;

  static auto force(const auto& term, const auto& q, std::size_t axis) {
    return q.velocity[axis] * interpolated(term.parameters, kEvenKnots, q.displacement[axis]);
  }
};

}  // namespace

std::span<const TermKind> spring_kinds() {
  return kinds_of<LinearStiffness, PolynomialStiffness, PiecewiseStiffness, PiecewiseDamping,
                  GapContact, TabulatedSpring, TabulatedDamper, TabulatedFriction,
                  TabulatedViscosity>();
}

}  // namespace rths::sim
