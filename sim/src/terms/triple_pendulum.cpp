// SPDX-License-Identifier: Apache-2.0
#include "triple_pendulum.hpp"

#include <algorithm>

#include <rths/core/error.hpp>

#include "fading_memory.hpp"
#include "sliding.hpp"

namespace rths::sim {
namespace {

// Time constant of the contact's heating. Without it, a quasi-static series of sliders with
// softening friction has no solution that depends continuously on its data.
constexpr double kHeatingTime = 0.02;  // [s]

struct TriplePendulum : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "triple_pendulum";
  static constexpr Text kTitle = "triple friction pendulum";
  static constexpr Text kEquation =
      "F = N phi,  u = u1 + u2 + u3,  phi = u_i/R_i + f_i + rim_i,  |f_i| <= mu_i";
  static constexpr Text kSource = "Fenz & Constantinou 2008; Dao, Ryan, Sato & Sasaki 2013";
  enum {
    kRadius = 0,
    kCapacity = 3,
    kFriction = 6,
    kReduction = 9,
    kArea = 12,
    kYieldDisplacement = 15,
    kRim = 18,
    kRate,
    kShare
  };
  // 1: each of the two inner surfaces; 2 and 3: the outer surfaces. Without radii: no effect.
  static constexpr Parameter kParameters[] = {{"radius_1", "m", 0, 100, 0, 0.4},
                                              {"radius_2", "m", 0, 100, 0, 2},
                                              {"radius_3", "m", 0, 100, 0, 2},
                                              {"capacity_1", "m", 0, 10, 10, 0.04},
                                              {"capacity_2", "m", 0, 10, 10, 0.25},
                                              {"capacity_3", "m", 0, 10, 10, 0.25},
                                              {"friction_1", "-", 0, 1, 0, 0.02},
                                              {"friction_2", "-", 0, 1, 0, 0.06},
                                              {"friction_3", "-", 0, 1, 0, 0.1},
                                              {"low_velocity_reduction_1", "-", 0, 1, 0, 0.3},
                                              {"low_velocity_reduction_2", "-", 0, 1, 0, 0.4},
                                              {"low_velocity_reduction_3", "-", 0, 1, 0, 0.5},
                                              {"contact_area_1", "m2", 1e-4, 100, 0.25, 0.25},
                                              {"contact_area_2", "m2", 1e-4, 100, 0.3, 0.3},
                                              {"contact_area_3", "m2", 1e-4, 100, 0.3, 0.3},
                                              {"yield_displacement_1", "m", 1e-5, 0.1, 1e-3, 1e-3},
                                              {"yield_displacement_2", "m", 1e-5, 0.1, 1e-3, 1e-3},
                                              {"yield_displacement_3", "m", 1e-5, 0.1, 1e-3, 1e-3},
                                              {"rim_stiffness", "1/m", 0, 1e7, 100, 100},
                                              {"rate", "s/m", 0, 1e4, 100, 20},
                                              {"heat_share", "-", 0, 1, 0, 0.9}};

  // Per segment: displacement, its last increment, total slip, mean flux into its surface, memory
  // of the flux.
  enum { kDisplacement = 0, kGrowth = 6, kSlipped = 12, kFlux = 18, kMemory = 21 };
  enum { kFluxGain = kFadingConstants, kConstants };

  static TermSize size(const TermSetup&) {
    return {kMemory + kSegments * kFadingStates, kConstants};
  }

  static void prepare(const TermSetup& setup, std::span<double> constants) {
    const auto& p = setup.parameters;
    const bool absent = p[kRadius] == 0 && p[kRadius + 1] == 0 && p[kRadius + 2] == 0;
    if (!absent && !(p[kRadius] > 0 && std::min(p[kRadius + 1], p[kRadius + 2]) > p[kRadius]))
      throw Error{
          "triple_pendulum: radius_2_m and radius_3_m must be larger than radius_1_m, "
          "and that larger than 0"};
    prepare_fading_memory(0.5, setup.time_step, constants.first(kFadingConstants));
    constants[kFluxGain] = -std::expm1(-setup.time_step / kHeatingTime);
  }

  template <class Real>
  static std::array<PendulumSegment<Real>, kSegments> segments_of(const TermView<Real>& term,
                                                                  const Quantities<Real>& q) {
    const Real* p = term.parameters;
    std::array<PendulumSegment<Real>, kSegments> segments;
    Real inner_clearance = 2 * p[kCapacity];
    for (std::size_t i = 1; i < kSegments; ++i) {
      const Real ratio = p[kRadius] / p[kRadius + i];
      segments[i].curvature = 1 / (p[kRadius + i] - p[kRadius]);
      segments[i].clearance = p[kCapacity + i] * (1 - ratio);
      segments[i].rate = p[kRate] / ((1 - ratio) * term.time_step);
      inner_clearance += p[kCapacity + i] * ratio;
    }
    segments[0].curvature = 1 / (2 * p[kRadius]);
    segments[0].clearance = inner_clearance;
    segments[0].rate = p[kRate] * (0.5 / term.time_step);
    for (std::size_t i = 0; i < kSegments; ++i) {
      PendulumSegment<Real>& segment = segments[i];
      segment.curvature *= q.stiffness;
      segment.elastic = p[kFriction + i] / p[kYieldDisplacement + i];
      segment.strength = p[kFriction + i] * q.strength;
      segment.reduction = p[kReduction + i];
      segment.rim = p[kRim];
      segment.slipped = point(term.state + kSlipped + 2 * i);
    }
    return segments;
  }

  // Reduces each friction by the heat of all earlier steps.
  template <class Real>
  static void soften(const TermView<Real>& term, const Quantities<Real>& q,
                     std::array<PendulumSegment<Real>, kSegments>& segments) {
    const Real& share = term.parameters[kShare];
    if constexpr (std::is_same_v<Real, double>)
      if (share == 0 && q.temperature == 0) return;
    const Real heating = share * steel_heating(kSteelConductivity, kSteelDiffusivity);
    for (std::size_t i = 0; i < kSegments; ++i) {
      Real* memory = term.state + kMemory + i * kFadingStates;
      const Real rise = heating * remember(term.constants, memory, term.state[kFlux + i]);
      const Real hotter = rise + q.temperature;
      segments[i].strength *=
          kResidualFriction + (1 - kResidualFriction) * exp(-(hotter * (1 / kTemperatureScale)));
    }
  }

  template <class Real>
  static Plane<Real> point(const Real* at) {
    return {at[0], at[1]};
  }
  template <class Real>
  static void put(const Plane<Real>& value, Real* at) {
    at[0] = value.x, at[1] = value.y;
  }

  // Start of the search: displacements extrapolated from the last step.
  template <class Real>
  static SeriesDisplacements expected(const TermView<Real>& term) {
    SeriesDisplacements at;
    for (std::size_t i = 0; i < kSegments; ++i) {
      const Plane<Real> u =
          point(term.state + kDisplacement + 2 * i) + point(term.state + kGrowth + 2 * i);
      at[i] = {value_of(u.x), value_of(u.y)};
    }
    return at;
  }

  // Heat of one surface's slip while its contact covers the middle; 0 otherwise.
  template <class Real>
  static Real heat(const Real& friction, const Plane<Real>& slip, const Plane<Real>& offset,
                   const Real& area) {
    return 4 * dot(offset, offset) > area ? Real{0} : Real{friction * length(slip) / area};
  }

  // Heat fluxes of the surfaces. Their slips follow from the segments'; the two inner surfaces
  // share one temperature.
  template <class Real>
  static void warm(const TermView<Real>& term, const Real& load,
                   const std::array<SegmentResponse<Real>, kSegments>& responses) {
    if constexpr (std::is_same_v<Real, double>)
      if (term.parameters[kShare] == 0) return;
    const Real* p = term.parameters;
    const Real per_time = load * (1 / term.time_step);
    const Plane<Real> inner = point(term.state + kDisplacement);
    std::array<Real, kSegments> flux{};
    for (std::size_t i = 1; i < kSegments; ++i) {
      const Real outer_share = p[kRadius + i] / (p[kRadius + i] - p[kRadius]);
      const Real inner_share = p[kRadius] / (p[kRadius + i] - p[kRadius]);
      const Plane<Real> outer = point(term.state + kDisplacement + 2 * i);
      flux[i] = heat(length(responses[i].friction), responses[i].slip * outer_share,
                     outer * outer_share, p[kArea + i]);
      flux[0] += 0.5 * heat(length(responses[0].friction),
                            responses[0].slip * Real{0.5} - responses[i].slip * inner_share,
                            inner * Real{0.5} - outer * inner_share, p[kArea]);
    }
    for (std::size_t i = 0; i < kSegments; ++i) {
      Real& mean = term.state[kFlux + i];
      mean += (flux[i] * per_time - mean) * term.constants[kFluxGain];
    }
  }

  // One more Newton step from the solution. It changes values by no more than their imbalance and
  // adds the derivatives with respect to parameters, history and displacement.
  template <class Real>
  static std::array<Plane<Real>, kSegments> settle(
      const std::array<PendulumSegment<Real>, kSegments>& segments, const Plane<Real>& total,
      const SeriesDisplacements& at) {
    std::array<Plane<Real>, kSegments> u, force;
    std::array<Symmetric, kSegments> compliance;
    Symmetric all;
    Plane<Real> sum = total;
    for (std::size_t i = 0; i < kSegments; ++i) {
      u[i] = {Real{at[i].x}, Real{at[i].y}};
      const SegmentResponse<Real> found = response_of(segments[i], u[i]);
      compliance[i] = found.tangent.inverse();
      force[i] = found.force;
      all += compliance[i];
      sum = sum - u[i] + compliance[i] * force[i];
    }
    const Plane<Real> common = all.inverse() * sum;
    for (std::size_t i = 0; i < kSegments; ++i) u[i] = u[i] + compliance[i] * (common - force[i]);
    return u;
  }

  template <class Real>
  static void keep(const TermView<Real>& term,
                   const std::array<PendulumSegment<Real>, kSegments>& segments,
                   const std::array<Plane<Real>, kSegments>& u,
                   const std::array<SegmentResponse<Real>, kSegments>& responses) {
    for (std::size_t i = 0; i < kSegments; ++i) {
      put(u[i] - point(term.state + kDisplacement + 2 * i), term.state + kGrowth + 2 * i);
      put(u[i], term.state + kDisplacement + 2 * i);
      put(segments[i].slipped + responses[i].slip, term.state + kSlipped + 2 * i);
    }
  }

  // All three segments carry the same force. Its frictional component is the mean of the frictions
  // weighted by the radii, because u = Σ R_i (F − f_i).
  template <class Real>
  static void act(const std::array<PendulumSegment<Real>, kSegments>& segments,
                  const std::array<SegmentResponse<Real>, kSegments>& responses,
                  Quantities<Real>& q) {
    Plane<Real> friction;
    Real radii{};
    for (std::size_t i = 0; i < kSegments; ++i) {
      const Real radius = 1 / segments[i].curvature;
      radii += radius;
      friction = friction + responses[i].friction * radius;
    }
    const Real load = contact_load(q);
    friction = friction * (load / radii);
    q.hysteretic_force[0] += friction.x, q.hysteretic_force[1] += friction.y;
    q.force[0] += responses[0].force.x * load, q.force[1] += responses[0].force.y * load;
  }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    if (!(term.parameters[kRadius] > 0)) return;
    auto segments = segments_of(term, q);
    soften(term, q, segments);
    const Plane<Real> total = displacement_of(q);
    SeriesDisplacements at = expected(term);
    const SeriesSolution solution =
        solve_series({plain(segments[0]), plain(segments[1]), plain(segments[2])},
                     {value_of(total.x), value_of(total.y)}, at);
    std::array<Plane<Real>, kSegments> u;
    std::array<SegmentResponse<Real>, kSegments> responses;
    if constexpr (std::is_same_v<Real, double>) {
      u = at;
      responses = solution.responses;
    } else {
      u = settle(segments, total, at);
      for (std::size_t i = 0; i < kSegments; ++i) responses[i] = response_of(segments[i], u[i]);
    }
    keep(term, segments, u, responses);
    warm(term, contact_load(q), responses);
    act(segments, responses, q);
  }
};

}  // namespace

std::span<const TermKind> triple_pendulum_kinds() { return kinds_of<TriplePendulum>(); }

}  // namespace rths::sim
