// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "triple_pendulum.hpp"

namespace rths::sim {
namespace {

// Relative imbalance at which the iteration ends.
constexpr double kTolerance = 1e-11;
// A line search ends when the energy's slope has fallen to a tenth.
constexpr double kEnoughSlope = 0.1;

using Segments = std::array<PendulumSegment<double>, kSegments>;
using Responses = std::array<SegmentResponse<double>, kSegments>;

Responses responses(const Segments& segments, const SeriesDisplacements& u) {
  return {response_of(segments[0], u[0]), response_of(segments[1], u[1]),
          response_of(segments[2], u[2])};
}

// The common force and the step towards it, with every segment linearised.
struct NewtonStep {
  Plane<double> force;
  SeriesDisplacements direction;
  double imbalance = 0, scale = 0;
  double slope = 0;  // of the energy along the direction, ≤ 0 once displacements add up
};

NewtonStep newton_step(const Responses& found, const Plane<double>& missing) {
  std::array<Symmetric, kSegments> compliance;
  Symmetric all;
  Plane<double> sum = missing;
  for (std::size_t i = 0; i < kSegments; ++i) {
    compliance[i] = found[i].tangent.inverse();
    all += compliance[i];
    sum = sum + compliance[i] * found[i].force;
  }
  NewtonStep step;
  step.force = all.inverse() * sum;
  for (std::size_t i = 0; i < kSegments; ++i) {
    const Plane<double> gap = step.force - found[i].force;
    step.direction[i] = compliance[i] * gap;
    step.slope -= dot(gap, step.direction[i]);
    step.imbalance = std::max(step.imbalance, length(gap));
    step.scale = std::max(step.scale, length(found[i].force));
  }
  return step;
}

SeriesDisplacements moved(const SeriesDisplacements& u, const NewtonStep& step, double fraction) {
  SeriesDisplacements to = u;
  for (std::size_t i = 0; i < kSegments; ++i) to[i] = u[i] + step.direction[i] * fraction;
  return to;
}

// The directions add up to round-off. Subtracting the common force keeps that from being amplified.
double slope_at(const Responses& found, const NewtonStep& step) {
  double slope = 0;
  for (std::size_t i = 0; i < kSegments; ++i)
    slope += dot(found[i].force - step.force, step.direction[i]);
  return slope;
}

// Line search along the direction of a step, which keeps the sum of displacements. The energy's
// slope increases along it; its zero is bracketed, so the next tangent is taken beyond a corner.
void search(const Segments& segments, const NewtonStep& step, SeriesDisplacements& u,
            Responses& found, SeriesSolution& solution) {
  const SeriesDisplacements from = u;
  double fraction = 1, before = 0, slope_before = step.slope, beyond = 0, slope_beyond = 0;
  bool last_over = true;
  while (solution.evaluations < kMostEvaluations) {
    u = moved(from, step, fraction);
    found = responses(segments, u);
    ++solution.evaluations;
    const double slope = slope_at(found, step);
    const bool first = beyond == 0;
    const bool over = slope > 0;
    // Illinois method: halve the slope of an end that did not move, so that both ends converge.
    if (!first && over == last_over) (over ? slope_before : slope_beyond) *= 0.5;
    (over ? beyond : before) = fraction;
    (over ? slope_beyond : slope_before) = slope;
    last_over = over;
    if (std::abs(slope) <= -kEnoughSlope * step.slope || (first && slope <= 0)) return;
    fraction = before + (beyond - before) * slope_before / (slope_before - slope_beyond);
  }
}

}  // namespace

SeriesSolution solve_series(const Segments& segments, const Plane<double>& total,
                            SeriesDisplacements& u) noexcept {
  double strength = 0;
  for (const auto& segment : segments) strength = std::max(strength, segment.strength);
  SeriesSolution solution;
  Responses& found = solution.responses;
  found = responses(segments, u);
  // The first step makes the displacements add up to `total`, so it is a full step.
  NewtonStep step = newton_step(found, total - (u[0] + u[1] + u[2]));
  u = moved(u, step, 1);
  found = responses(segments, u);
  solution.evaluations = 2;
  while (true) {
    step = newton_step(found, total - (u[0] + u[1] + u[2]));
    solution.imbalance = step.imbalance;
    if (step.imbalance <= kTolerance * (strength + step.scale)) break;
    search(segments, step, u, found, solution);
    if (solution.evaluations >= kMostEvaluations) break;
  }
  return solution;
}

}  // namespace rths::sim
