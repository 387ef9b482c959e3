// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/sim/composition.hpp>

#include "sim/src/terms/triple_pendulum.hpp"
#include "support/files.hpp"

namespace rths::sim {
namespace {

constexpr double kPendulumLoad = 9.7e6;  // [N]

struct Dimensions {
  double inner_radius = 0.4, inner_capacity = 0.03, inner_friction = 0.02;
  std::array<double, 2> radius{2.0, 2.4}, capacity{0.2, 0.21}, friction{0.06, 0.09};
};

std::vector<std::pair<std::string, double>> parameters_of(const Dimensions& d) {
  return {{"radius_1", d.inner_radius},
          {"radius_2", d.radius[0]},
          {"radius_3", d.radius[1]},
          {"capacity_1", d.inner_capacity},
          {"capacity_2", d.capacity[0]},
          {"capacity_3", d.capacity[1]},
          {"friction_1", d.inner_friction},
          {"friction_2", d.friction[0]},
          {"friction_3", d.friction[1]},
          {"yield_displacement_1", 1e-5},
          {"yield_displacement_2", 1e-5},
          {"yield_displacement_3", 1e-5},
          {"rim_stiffness", 1e5}};
}

Composition bearing_of(const Dimensions& d, double time_step = 1e-3) {
  return Composition{{{"triple_pendulum", "", parameters_of(d)}}, time_step};
}

double force_at(const Composition& bearing, std::vector<double>& state, double u,
                double load = kPendulumLoad) {
  Quantities<double> q;
  q.displacement = {u, 0};
  q.axial_load = load;
  bearing.advance(state, q);
  return q.force[0] / kPendulumLoad;
}

// The polygon derived from the physical surfaces; forces are divided by the load. At first both
// inner surfaces slide. When an outer surface slides, the inner one on its side moves with it. When
// that outer surface is at its stop, the inner one on its side slides again. So the displacement
// per unit of force is
//     2 L1 (inner only), L1 + Lj (outer j and the inner one of the other side), L2 + L3 (both
//     outer).
struct Polygon {
  struct Corner {
    double u, force;
  };
  Dimensions d;
  // Branch from (u, force) in a direction: outer surface j slides between the forces `begin` and
  // `end`. Forces and displacements are positive along the direction.
  std::vector<Corner> branch(const Corner& from, double inner_begin,
                             const std::array<double, 2>& begin, const std::array<double, 2>& end,
                             double until) const {
    std::vector<double> forces{from.force, inner_begin, begin[0], begin[1], end[0], end[1], until};
    std::sort(forces.begin(), forces.end());
    std::vector<Corner> corners{from};
    for (const double force : forces) {
      if (force <= corners.back().force || force > until) continue;
      const double middle = 0.5 * (force + corners.back().force);
      double flexibility = middle < inner_begin ? 0 : 2 * d.inner_radius;
      for (std::size_t j = 0; j < 2; ++j)
        if (middle > begin[j] && middle < end[j]) flexibility += d.radius[j] - d.inner_radius;
      corners.push_back({corners.back().u + flexibility * (force - corners.back().force), force});
    }
    return corners;
  }
  double stop(std::size_t j) const { return d.friction[j] + d.capacity[j] / d.radius[j]; }
  std::vector<Corner> virgin(double until) const {
    return branch({0, 0}, d.inner_friction, d.friction, {stop(0), stop(1)}, until);
  }
  // Unloading from a peak of the virgin branch to the opposite peak, measured from the first peak.
  std::vector<Corner> back(const Corner& peak) const {
    std::array<double, 2> begin{}, end{};
    for (std::size_t j = 0; j < 2; ++j) {
      // At the stop, the rim unloads first: friction reverses below d/L.
      const double at_peak = std::min(peak.force, stop(j));
      begin[j] = peak.force <= d.friction[j] ? 1e9 : 2 * d.friction[j] - at_peak;
      end[j] = stop(j);
    }
    auto corners =
        branch({-peak.u, -peak.force}, 2 * d.inner_friction - peak.force, begin, end, peak.force);
    for (auto& corner : corners) corner = {-corner.u, -corner.force};
    return corners;
  }
};

// Moves from corner to corner in small steps and compares each point.
void expect_on(const Composition& bearing, std::vector<double>& state,
               const std::vector<Polygon::Corner>& corners, double tolerance) {
  constexpr int kSteps = 400;
  for (std::size_t i = 1; i < corners.size(); ++i)
    for (int k = 1; k <= kSteps; ++k) {
      const double fraction = static_cast<double>(k) / kSteps;
      const double u = corners[i - 1].u + fraction * (corners[i].u - corners[i - 1].u);
      const double expected =
          corners[i - 1].force + fraction * (corners[i].force - corners[i - 1].force);
      if (corners[i].u == corners[i - 1].u) continue;  // sticking: a jump of the polygon
      ASSERT_NEAR(force_at(bearing, state, u), expected, tolerance) << "side " << i << ", " << u;
    }
}

// Peaks in regimes I to V. The polygon omits the elastic displacement of 1e-5 m per slider and
// 1e-5 m/N·N per stop: together below 5e-5 m on the stiffest side, 1/(2 L1).
TEST(TriplePendulum, FollowsTheAnalyticPolygonInEveryRegime) {
  const Polygon polygon{Dimensions{}};
  for (const double peak : {0.05, 0.08, 0.15, 0.17, 0.185}) {
    const Composition bearing = bearing_of(polygon.d);
    std::vector<double> state(bearing.states());
    const auto up = polygon.virgin(peak);
    const double tolerance = 1e-3 * peak;

    expect_on(bearing, state, up, tolerance);
    const auto down = polygon.back(up.back());
    expect_on(bearing, state, down, tolerance);
    // Reloading: the loop is symmetric.
    auto again = down;
    for (auto& corner : again) corner = {-corner.u, -corner.force};
    expect_on(bearing, state, again, tolerance);
  }
}

TEST(TriplePendulum, HasTheCapacityOfAllItsSurfaces) {
  const Dimensions d;
  const Composition bearing = bearing_of(d);
  std::vector<double> state(bearing.states());
  const double capacity = 2 * d.inner_capacity + d.capacity[0] + d.capacity[1];
  double before = 0, contact = 0;
  for (double u = 0; u < 1.05 * capacity; u += 1e-4) {
    const double force = force_at(bearing, state, u);
    if (contact == 0 && u > 0.01 && force - before > 3 * 1e-4 / (2 * d.inner_radius)) contact = u;
    before = force;
  }

  EXPECT_NEAR(contact, capacity, 5e-4);
}

TEST(TriplePendulum, IsTheSameInEveryDirection) {
  const Composition bearing = bearing_of(Dimensions{});
  std::vector<double> along(bearing.states()), across(bearing.states());
  for (int i = 0; i <= 2000; ++i) {
    const double u = 0.4 * std::sin(0.005 * i);
    Quantities<double> q;
    q.displacement = {0.6 * u, 0.8 * u};
    q.axial_load = kPendulumLoad;
    bearing.advance(across, q);
    const double expected = force_at(bearing, along, u) * kPendulumLoad;
    ASSERT_NEAR(q.force[0], 0.6 * expected, 1e-8 * kPendulumLoad);
    ASSERT_NEAR(q.force[1], 0.8 * expected, 1e-8 * kPendulumLoad);
  }
}

TEST(TriplePendulum, HasNoForceInUpliftAndReturnsToItsLoop) {
  const Composition bearing = bearing_of(Dimensions{});
  std::vector<double> held(bearing.states()), lifted(bearing.states());
  for (int i = 1; i <= 3000; ++i) {
    const double u = 1e-4 * i;
    const bool up = i > 1000 && i < 2000;
    const double expected = force_at(bearing, held, u);
    const double force = force_at(bearing, lifted, u, up ? -1e5 : kPendulumLoad);
    EXPECT_EQ(force, up ? 0 : expected);
  }
}

// Steady sliding: friction 1 − x e^(−a v) with each surface's own velocity. In regime III outer
// surface j moves at v Lj/(L2 + L3).
TEST(TriplePendulum, HasTheFrictionOfEachSurfacesOwnVelocity) {
  const Dimensions d;
  const double dt = 1e-3, a = 20;
  const std::array<double, 2> reduction{0.5, 0.3};
  for (const double v : {0.02, 0.1, 0.4}) {
    auto parameters = parameters_of(d);
    parameters.insert(parameters.end(), {{"low_velocity_reduction_2", reduction[0]},
                                         {"low_velocity_reduction_3", reduction[1]},
                                         {"rate", a}});
    const Composition bearing{{{"triple_pendulum", "", parameters}}, dt};
    std::vector<double> state(bearing.states());
    const double both = d.radius[0] + d.radius[1];
    double force = 0;
    const int steps = static_cast<int>(0.3 / (v * dt));
    const double u = steps * v * dt;
    for (int i = 1; i <= steps; ++i) force = force_at(bearing, state, i * v * dt);
    // u = 2 L1 (F − f1) + Σ (Lj − L1)(F − fj)
    double friction = 2 * d.inner_radius * d.inner_friction;
    for (std::size_t j = 0; j < 2; ++j)
      friction += (d.radius[j] - d.inner_radius) * d.friction[j] *
                  (1 - reduction[j] * std::exp(-a * v * d.radius[j] / both));

    EXPECT_NEAR(force, (u + friction) / both, 1e-3 * force) << v << " m/s";
  }
}

// In steady sliding each outer surface receives mu N v_j/A, and its temperature grows with √t. The
// remaining friction is checked once the flux's time constant of 20 ms is short against the slide.
TEST(TriplePendulum, HeatsEachSurfaceByItsOwnFriction) {
  Dimensions d;
  d.capacity = {10, 10};
  const double dt = 1e-3, v = 0.1, time = 2, area = 0.15;
  auto parameters = parameters_of(d);
  parameters.insert(parameters.end(), {{"heat_share", 1},
                                       {"contact_area_1", area},
                                       {"contact_area_2", area},
                                       {"contact_area_3", area}});
  const Composition bearing{{{"triple_pendulum", "", parameters}}, dt};
  std::vector<double> state(bearing.states());
  const double both = d.radius[0] + d.radius[1];
  double force = 0;
  for (int i = 1; i <= static_cast<int>(time / dt); ++i)
    force = force_at(bearing, state, i * v * dt);

  // The same integral, summed over the whole history as in the published models.
  const double step = 0.01;
  const int steps = static_cast<int>(time / step);
  double friction = 2 * d.inner_radius * d.inner_friction;
  for (std::size_t j = 0; j < 2; ++j) {
    std::vector<double> flux;
    double factor = 1;
    for (int i = 1; i <= steps; ++i) {
      flux.push_back(d.friction[j] * factor * kPendulumLoad * v * d.radius[j] / both / area);
      double memory = 0;
      for (int k = 0; k < i; ++k)
        memory += flux[static_cast<std::size_t>(k)] * 2 *
                  (std::sqrt((i - k) * step) - std::sqrt((i - k - 1) * step));
      const double temperature = 20 + std::sqrt(4.44e-6 / std::numbers::pi) / 18 * memory;
      factor = (std::pow(0.7, temperature / 50) + 0.4) / (std::pow(0.7, 0.4) + 0.4);
    }
    friction += (d.radius[j] - d.inner_radius) * d.friction[j] * factor;
    EXPECT_LT(factor, 0.9);
  }
  EXPECT_NEAR(force, (v * time + friction) / both, 0.01 * force);
}

TEST(TriplePendulum, RefusesImpossibleRadii) {
  Dimensions d;
  d.radius[1] = 0.3;
  EXPECT_EQ(test::error_of([&] { bearing_of(d); }),
            "triple_pendulum: radius_2_m and radius_3_m must be larger than radius_1_m, and that "
            "larger than 0");
}

// Violent random motion through all regimes, stops included, at 1 kHz.
TEST(TriplePendulumSeries, ConvergesInAFewIterationsForAnyMotion) {
  const double dt = 1e-3;
  for (const double reduction : {0.0, 0.5})
    for (const double kick : {1.0, 4.0}) {
      std::array<PendulumSegment<double>, kSegments> segments{
          PendulumSegment<double>{1 / 0.8, 20, 0.02, reduction, 50 / dt, 0.18, 100},
          PendulumSegment<double>{1 / 1.6, 60, 0.06, reduction, 125 / dt, 0.2, 100},
          PendulumSegment<double>{1 / 1.6, 100, 0.10, reduction, 125 / dt, 0.2, 100}};
      std::mt19937_64 random{7};
      std::normal_distribution<double> normal;
      Plane<double> u, v;
      SeriesDisplacements at{}, before{};
      std::vector<int> evaluations;
      for (int i = 0; i < 50'000; ++i) {
        const Plane<double> noise{normal(random), normal(random)};
        v = v + (v * (-1 / 0.2) + u * -4.4) * dt + noise * (kick * std::sqrt(dt));
        u = u + v * dt;
        SeriesDisplacements next = at;
        for (std::size_t k = 0; k < kSegments; ++k) next[k] = at[k] * 2.0 - before[k];
        before = at;
        const SeriesSolution solution = solve_series(segments, u, next);
        at = next;
        evaluations.push_back(solution.evaluations);
        ASSERT_LT(solution.imbalance, 1e-8) << "step " << i;
        for (std::size_t k = 0; k < kSegments; ++k)
          segments[k].slipped = segments[k].slipped + response_of(segments[k], at[k]).slip;
      }
      std::sort(evaluations.begin(), evaluations.end());
      // The first evaluation is at the start point: six Newton steps.
      EXPECT_LE(evaluations[evaluations.size() * 99 / 100], 1 + 6);
      EXPECT_LT(evaluations.back(), kMostEvaluations);
    }
}

}  // namespace
}  // namespace rths::sim
