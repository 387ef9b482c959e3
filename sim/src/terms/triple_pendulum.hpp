// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "plane.hpp"

namespace rths::sim {

// Three segments in series, each a spring, a slider and a stop side by side. Forces are per axial
// load, so that all of it is independent of the load. Equations: docs/theory/triple_pendulum.md.

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
struct Segment {
  Real curvature;         ///< of the spring [1/m], > 0
  Real elastic;           ///< stiffness of the slider before it slides [1/m]
  Real strength;          ///< friction at high velocity [-]
  Real reduction;         ///< of friction at no velocity, part of strength [-]
  Real rate;              ///< at which the reduction goes with the slip in a step [1/m]
  Real clearance;         ///< of the stop [m]
  Real rim;               ///< its stiffness [1/m]
  Plane<Real> slipped{};  ///< by the slider before this step [m]
};

/// What a segment answers to a displacement.
template <class Real>
struct Answer {
  Plane<Real> force, friction, slip;  ///< all of it, the slider's part, its slip [-, -, m]
  Symmetric tangent{};                ///< [1/m]
};

/// Slip in this step of a slider drawn by `trial` beyond its strength at no velocity: the root of
///     trial − elastic s − strength (1 − reduction e^(−rate s)) = 0
/// which is convex and falls, so that Newton from the left stays there.
template <class Real>
[[nodiscard]] double slip_of(const Segment<Real>& segment, double trial) noexcept {
  constexpr int kMostIterations = 12;
  const double elastic = value_of(segment.elastic), strength = value_of(segment.strength);
  const double reduction = value_of(segment.reduction), rate = value_of(segment.rate);
  double slip = std::max(0.0, (trial - strength) / elastic);
  if (reduction == 0) return slip;
  for (int i = 0; i < kMostIterations; ++i) {
    const double lost = strength * reduction * std::exp(-rate * slip);
    const double excess = trial - elastic * slip - strength + lost;
    slip += excess / (elastic + rate * lost);
    if (excess <= 1e-13 * trial) break;
  }
  return slip;
}

template <class Real>
[[nodiscard]] Answer<Real> answer(const Segment<Real>& segment, const Plane<Real>& u) noexcept {
  using std::exp;
  const auto plain = [](const Plane<Real>& a) {
    return Plane<double>{value_of(a.x), value_of(a.y)};
  };
  Answer<Real> result;
  result.force = u * segment.curvature;
  result.tangent.xx = result.tangent.yy = value_of(segment.curvature);

  const Plane<Real> stretch = u - segment.slipped;
  const Real size = length(stretch);
  const Real trial = segment.elastic * size;
  const double elastic = value_of(segment.elastic);
  if (trial > segment.strength * (1 - segment.reduction)) {
    // One Newton step from the root changes no value; it carries the derivatives.
    const double root = slip_of(segment, value_of(trial));
    const Real lost = segment.strength * segment.reduction * exp(-(segment.rate * root));
    const double slope = elastic + value_of(segment.rate) * value_of(lost);
    const Real slip =
        root + (trial - segment.elastic * root - segment.strength + lost) * (1 / slope);
    const Plane<Real> direction = stretch * (1 / size);
    result.slip = direction * slip;
    result.friction = direction * (trial - segment.elastic * slip);
    result.tangent.add(plain(direction), elastic * (1 - elastic / slope),
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
    result.tangent.add(plain(u * (1 / radius)), value_of(segment.rim), value_of(push));
  }
  return result;
}

using SeriesDisplacements = std::array<Plane<double>, kSegments>;

struct SeriesSolution {
  int evaluations = 0;   ///< of all three segments, ≤ kMostEvaluations
  double imbalance = 0;  ///< largest difference between a segment's force and that of all [-]
};

inline constexpr int kMostEvaluations = 30;

/// Displacements of the segments that add up to `total` under one force: the minimum of a convex
/// energy, by Newton's method with a search along its direction. Whatever happens, they add up.
/// @param u  in: where to begin; out: the solution   @realtime
SeriesSolution solve_series(const std::array<Segment<double>, kSegments>& segments,
                            const Plane<double>& total, SeriesDisplacements& u) noexcept;

}  // namespace rths::sim
