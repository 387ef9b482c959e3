// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/lead_rubber.hpp>

#include <algorithm>
#include <cmath>

namespace rths::sim {
namespace {

constexpr double kPartOfYieldDisplacement = 0.05;
constexpr int kMaxParts = 64;

using Eigen::Vector2d;

// dz for an increment du, both in the bearing's frame.
Vector2d hysteresis_rate(const LeadRubber& bearing, const Vector2d& z, const Vector2d& du) {
  const double work = z.dot(du);
  const double sign = work > 0 ? 1.0 : (work < 0 ? -1.0 : 0.0);
  const double radius = z.norm();
  const double sharpness = bearing.eta == 2.0 ? 1.0 : std::pow(radius, bearing.eta - 2.0);
  return (du - z * (sharpness * work * (bearing.gamma + bearing.beta * sign))) /
         bearing.yield_displacement();
}

void runge_kutta_part(const LeadRubber& bearing, Vector2d& z, const Vector2d& du) {
  const Vector2d k1 = hysteresis_rate(bearing, z, du);
  const Vector2d k2 = hysteresis_rate(bearing, z + 0.5 * k1, du);
  const Vector2d k3 = hysteresis_rate(bearing, z + 0.5 * k2, du);
  const Vector2d k4 = hysteresis_rate(bearing, z + k3, du);
  z += (k1 + 2 * k2 + 2 * k3 + k4) / 6;
  // |z| ≤ 1 holds exactly for the law; the integration may leave it by its error.
  if (const double radius = z.norm(); radius > 1) z /= radius;
}

}  // namespace

Vector2d advance(const LeadRubber& bearing, LeadRubberState& state,
                 const Vector2d& displacement) noexcept {
  const Vector2d increment = displacement - state.displacement;
  const double part = kPartOfYieldDisplacement * bearing.yield_displacement();
  const int parts =
      static_cast<int>(std::clamp(std::ceil(increment.norm() / part), 1.0, double{kMaxParts}));
  for (int i = 0; i < parts; ++i) runge_kutta_part(bearing, state.hysteresis, increment / parts);
  state.displacement = displacement;
  return bearing.post_yield_stiffness * displacement +
         bearing.characteristic_strength * state.hysteresis;
}

}  // namespace rths::sim
