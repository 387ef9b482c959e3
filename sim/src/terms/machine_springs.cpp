// SPDX-License-Identifier: Apache-2.0
#include "kinds.hpp"

namespace rths::sim {
namespace {

struct PolynomialStiffness : Acts<Stage::Restoring, kPerAxis> {
  static constexpr Text kName = "polynomial_stiffness";
  static constexpr Text kTitle = "polynomial spring";
  static constexpr Text kEquation =
      "F = f (k_1 u + k_2 u^2 + k_3 u^3),  f: stiffness factor of modifiers";
  static constexpr Text kSource = "textbook";
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
  static constexpr Text kSource = "textbook";
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
  static constexpr Text kSource = "textbook";
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

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      const double side = value_of(q.displacement[axis]) < 0 ? -1 : 1;
      const Real depth = abs(q.displacement[axis]) - term.parameters[kGap];
      const Real hold = 1 + term.parameters[kLoss] * q.velocity[axis] * side;
      if (depth > 0 && hold > 0) q.force[axis] += term.parameters[kStiffness] * depth * hold * side;
    });
  }
};

}  // namespace

std::span<const TermKind> spring_kinds() {
  return kinds_of<PolynomialStiffness, PiecewiseStiffness, PiecewiseDamping, GapContact>();
}

}  // namespace rths::sim
