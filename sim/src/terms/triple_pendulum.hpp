// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "plane.hpp"

namespace rths::sim {

// Three segments in series, each a spring, a slider and a stop in parallel. Forces are divided by
// the axial load, so the equations do not depend on it. Equations: docs/theory/triple_pendulum.md.

inline constexpr std::size_t kSegments = 3;

/// Symmetric 2×2 matrix.
struct Symmetric {
  double xx = 0, xy = 0, yy = 0;

  [[nodiscard]] Symmetric inverse() const {
    const double scale = 1 / (xx * yy - xy * xy);
    return {yy * scale, -xy * scale, xx * scale};
  }
  template <class Real>
  [[nodiscard]] Plane<Real> operator*(const Plane<Real>& a) const {
    return {a.x * xx + a.y * xy, a.x * xy + a.y * yy};
  }
  Symmetric& operator+=(const Symmetric& other) {
    xx += other.xx, xy += other.xy, yy += other.yy;
    return *this;
  }
  /// Adds `along` n·nᵀ + `across` (I − n·nᵀ).
  void add(const Plane<double>& n, double along, double across) {
    xx += across + (along - across) * n.x * n.x;
    xy += (along - across) * n.x * n.y;
    yy += across + (along - across) * n.y * n.y;
  }
};

template <class Real>
struct PendulumSegment {
  Real curvature;         ///< of the spring [1/m], > 0
  Real elastic;           ///< stiffness of the slider before it slides [1/m]
  Real strength;          ///< friction at high velocity [-]
  Real reduction;         ///< of friction at zero velocity, fraction of strength [-]
  Real rate;              ///< decay of the reduction with the slip in a step [1/m]
  Real clearance;         ///< of the stop [m]
  Real rim;               ///< its stiffness [1/m]
  Plane<Real> slipped{};  ///< by the slider before this step [m]
};

/// Response of a segment to a displacement.
template <class Real>
struct SegmentResponse {
  Plane<Real> force, friction, slip;  ///< total, the slider's share, its slip [-, -, m]
  Symmetric tangent{};                ///< [1/m]
};

/// Slip of a slider in this step, and the deficit of its friction to its strength.
struct Slip {
  double slip = 0, lost = 0;
};

/// Slip s of a slider whose trial force exceeds its strength at zero velocity: the root of
///     trial − elastic s − strength (1 − reduction e^(−rate s)) = 0
/// The function is convex and decreasing, so Newton's method from the left converges monotonically.
[[nodiscard]] inline Slip slip_of(const PendulumSegment<double>& segment, double trial) noexcept {
  constexpr int kMostIterations = 12;
  constexpr double kTolerance = 1e-13;  // per trial force
  Slip result{std::max(0.0, (trial - segment.strength) / segment.elastic), 0};
  if (segment.reduction == 0) return result;
  for (int i = 0; i < kMostIterations; ++i) {
    result.lost = segment.strength * segment.reduction * std::exp(-segment.rate * result.slip);
    const double excess = trial - segment.elastic * result.slip - segment.strength + result.lost;
    const double step = excess / (segment.elastic + segment.rate * result.lost);
    result.slip += step;
    // The residual after a step is half the curvature of `lost` times the step squared.
    const double bend = segment.rate * step;
    if (0.5 * result.lost * bend * bend <= kTolerance * trial) {
      result.lost *= 1 - bend;
      break;
    }
  }
  return result;
}

/// Values without their derivatives.
template <class Real>
[[nodiscard]] PendulumSegment<double> plain(const PendulumSegment<Real>& s) noexcept {
  return {value_of(s.curvature), value_of(s.elastic),
          value_of(s.strength),  value_of(s.reduction),
          value_of(s.rate),      value_of(s.clearance),
          value_of(s.rim),       {value_of(s.slipped.x), value_of(s.slipped.y)}};
}

/// One Newton step from the root: keeps the value and adds the derivatives.
template <class Real>
[[nodiscard]] Real carried(const PendulumSegment<Real>& segment, const Real& trial,
                           const Slip& root, double slope) noexcept {
  if constexpr (std::is_same_v<Real, double>) return root.slip;
  const Real lost = segment.strength * segment.reduction * exp(-(segment.rate * root.slip));
  return root.slip + (trial - segment.elastic * root.slip - segment.strength + lost) * (1 / slope);
}

template <class Real>
[[nodiscard]] SegmentResponse<Real> response_of(const PendulumSegment<Real>& segment,
                                                const Plane<Real>& u) noexcept {
  const auto values = [](const Plane<Real>& a) {
    return Plane<double>{value_of(a.x), value_of(a.y)};
  };
  SegmentResponse<Real> result;
  result.force = u * segment.curvature;
  result.tangent.xx = result.tangent.yy = value_of(segment.curvature);

  const Plane<Real> stretch = u - segment.slipped;
  const Real size = length(stretch);
  const Real trial = segment.elastic * size;
  const double elastic = value_of(segment.elastic);
  if (trial > segment.strength * (1 - segment.reduction)) {
    const Slip root = slip_of(plain(segment), value_of(trial));
    const double slope = elastic + value_of(segment.rate) * root.lost;
    const Real slip = carried(segment, trial, root, slope);
    const Plane<Real> direction = stretch * (1 / size);
    result.slip = direction * slip;
    result.friction = direction * (trial - segment.elastic * slip);
    result.tangent.add(values(direction), elastic * (1 - elastic / slope),
                       elastic * (1 - value_of(slip) / value_of(size)));
  } else {
    result.friction = stretch * segment.elastic;
    result.tangent.xx += elastic, result.tangent.yy += elastic;
  }
  result.force = result.force + result.friction;

  const Real radius = length(u);
  if (radius > segment.clearance) {
    const Real push = segment.rim * (radius - segment.clearance) / radius;
    result.force = result.force + u * push;
    result.tangent.add(values(u * (1 / radius)), value_of(segment.rim), value_of(push));
  }
  return result;
}

using SeriesDisplacements = std::array<Plane<double>, kSegments>;

struct SeriesSolution {
  int evaluations = 0;   ///< of all three segments, ≤ kMostEvaluations
  double imbalance = 0;  ///< largest difference between a segment's and the common force [-]
  std::array<SegmentResponse<double>, kSegments> responses{};
};

inline constexpr int kMostEvaluations = 30;

/// Displacements of the segments that add up to `total` under a common force: the minimum of a
/// convex energy, by Newton's method with a line search. They add up to `total` even without
/// convergence.
/// @param u  in: start of the search; out: the solution   @realtime
SeriesSolution solve_series(const std::array<PendulumSegment<double>, kSegments>& segments,
                            const Plane<double>& total, SeriesDisplacements& u) noexcept;

}  // namespace rths::sim
