// SPDX-License-Identifier: Apache-2.0
#include "sliding.hpp"

#include "hysteresis.hpp"

namespace rths::sim {
namespace {

struct PendulumLift : Acts<Stage::Vertical, kFrameIndifferent> {
  static constexpr Text kName = "pendulum_lift";
  static constexpr Text kTitle = "lift of a pendulum bearing";
  static constexpr Text kEquation = "w = w - |u|^2/(2 R),  dw/dt = dw/dt - u.v/R";
  static constexpr Text kSource = "sphere, small slopes";
  enum { kRadius };
  static constexpr Parameter kParameters[] = {{"effective_radius", "m", 0, 100, 0, 4}};  // 0: flat

  static void step(const auto& term, auto& q) {
    const auto& radius = term.parameters[kRadius];
    if (!(radius > 0)) return;
    const auto u = displacement_of(q);
    // The slider climbs, so the same distance between the plates compresses it more.
    q.vertical_displacement -= dot(u, u) / (2 * radius);
    q.vertical_velocity -= dot(u, velocity_of(q)) / radius;
  }
};

struct MultilinearAxial : Acts<Stage::Vertical> {
  static constexpr Text kName = "multilinear_axial";
  static constexpr Text kTitle = "multilinear elastic and viscous axial spring";
  static constexpr Text kEquation =
      "N += K1 e + (K2 - K1) max(0, e - e1) + (K3 - K2) max(0, e - e2) + c de/dt >= 0,  e = -w > "
      "0; "
      "K_t e in tension";
  static constexpr Text kSource = "paper's axial model; corners ours";
  enum { kStiffness1, kKnee1, kStiffness2, kKnee2, kStiffness3, kTension, kDamping };
  static constexpr Parameter kParameters[] = {
      {"stiffness_1", "N/m", 0, 1e13, 0, 3e9}, {"knee_1", "m", 0, 1, 1, 1.5e-3},
      {"stiffness_2", "N/m", 0, 1e13, 0, 5e9}, {"knee_2", "m", 0, 1, 1, 2.4e-3},
      {"stiffness_3", "N/m", 0, 1e13, 0, 7e9}, {"tension_stiffness", "N/m", 0, 1e13, 0, 1e9},
      {"damping", "N*s/m", 0, 1e10, 0, 1e7}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real* p = term.parameters;
    const Real e = -q.vertical_displacement;
    if (!(e > 0)) {
      q.axial_load += p[kTension] * e;
      return;
    }
    Real load = p[kStiffness1] * e - p[kDamping] * q.vertical_velocity;
    if (e > p[kKnee1]) load += (p[kStiffness2] - p[kStiffness1]) * (e - p[kKnee1]);
    if (e > p[kKnee2]) load += (p[kStiffness3] - p[kStiffness2]) * (e - p[kKnee2]);
    // No tension while the plates separate faster than the spring can follow.
    if (load > 0) q.axial_load += load;
  }
};

// States of a slider: displacement before, friction force.
enum { kBefore, kFrictionState = 2, kSliderStates = 4 };

// Advances a slider's friction by one step. In uplift the friction force is zero.
template <class Real>
Plane<Real> friction(const TermView<Real>& term, const Quantities<Real>& q, const Real& stiffness,
                     const Real& yield) {
  const Plane<Real> u = displacement_of(q);
  Plane<Real> force{term.state[kFrictionState], term.state[kFrictionState + 1]};
  slide(force, u - Plane<Real>{term.state[kBefore], term.state[kBefore + 1]}, stiffness, yield);
  term.state[kBefore] = u.x, term.state[kBefore + 1] = u.y;
  term.state[kFrictionState] = force.x, term.state[kFrictionState + 1] = force.y;
  return force;
}

struct FlatSlider : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "flat_slider";
  static constexpr Text kTitle = "flat slider";
  static constexpr Text kEquation = "F = k0 (u - u_p),  |F| <= mu N,  N = max(0, load)";
  static constexpr Text kSource = "Constantinou, Mokha & Reinhorn 1990; step of Krieg & Krieg 1977";
  enum { kCoefficient, kStiffness };
  static constexpr Parameter kParameters[] = {{"friction_coefficient", "-", 0, 1, 0, 0.1},
                                              {"initial_stiffness", "N/m", 1, 1e12, 4e8, 4e8}};
  static constexpr std::size_t kStates = kSliderStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real yield = term.parameters[kCoefficient] * q.strength * contact_load(q);
    resist(q, friction(term, q, term.parameters[kStiffness], yield), Real{0});
  }
};

struct SinglePendulum : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "single_pendulum";
  static constexpr Text kTitle = "single friction pendulum (slider on a sphere)";
  static constexpr Text kEquation =
      "F = N u/R + k0 (u - u_p),  |k0 (u - u_p)| <= mu N,  N = max(0, load)";
  static constexpr Text kSource = "Zayas, Low & Mahin 1987; small slopes";
  enum { kCoefficient, kStiffness, kRadius };
  static constexpr Parameter kParameters[] = {
      {"friction_coefficient", "-", 0, 1, 0, 0.06},
      {"initial_stiffness", "N/m", 1, 1e12, 4e8, 4e8},
      {"effective_radius", "m", 0, 100, 0, 2.2}};  // 0: flat
  static constexpr std::size_t kStates = kSliderStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real load = contact_load(q);
    const Real yield = term.parameters[kCoefficient] * q.strength * load;
    const Real& radius = term.parameters[kRadius];
    const Real stiffness = radius > 0 ? Real{q.stiffness * load / radius} : Real{0};
    resist(q, friction(term, q, term.parameters[kStiffness], yield), stiffness);
  }
};

struct RimStop : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "rim_stop";
  static constexpr Text kTitle = "contact with the rim";
  static constexpr Text kEquation = "F = k g (1 + a dg/dt) u/|u|,  g = |u| - d,  no pull";
  static constexpr Text kSource = "Hunt & Crossley 1975, exponent 1";
  enum { kStiffness, kClearance, kLoss };
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m", 0, 1e15, 0, 1e8},
                                              {"clearance", "m", 0, 10, 1, 0.12},
                                              {"loss", "s/m", 0, 100, 0, 0.5}};

  static void step(const auto& term, auto& q) {
    const auto u = displacement_of(q);
    const auto radius = length(u);
    const auto depth = radius - term.parameters[kClearance];
    if (!(depth > 0) || !(radius > 0)) return;
    const auto rate = dot(u, velocity_of(q)) / radius;
    const auto push = term.parameters[kStiffness] * depth * (1 + term.parameters[kLoss] * rate);
    if (!(push > 0)) return;
    q.force[0] += push * u.x / radius;
    q.force[1] += push * u.y / radius;
  }
};

struct MerSpring : Acts<Stage::Restoring, kDissipative | kPerAxis> {
  static constexpr Text kName = "mer_spring";
  static constexpr Text kTitle = "pair of compression-only springs on each axis";
  static constexpr Text kEquation = "F = K (max(0, u - gap) - max(0, -u - gap))";
  static constexpr Text kSource = "EradiQuake: mass energy regulators; linear";
  enum { kStiffness, kGap };
  // A negative gap is a precompression: near the middle both springs push.
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m", 0, 1e15, 0, 1.2e7},
                                              {"gap", "m", -1, 1, 0, 0.01}};

  static void step(const auto& term, auto& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      const auto& u = q.displacement[axis];
      const auto& gap = term.parameters[kGap];
      const auto stiffness = term.parameters[kStiffness] * q.stiffness;
      if (u > gap) q.force[axis] += stiffness * (u - gap);
      if (-u > gap) q.force[axis] += stiffness * (u + gap);
    });
  }
};

}  // namespace

std::span<const TermKind> sliding_vertical_kinds() {
  return kinds_of<PendulumLift, MultilinearAxial>();
}

std::span<const TermKind> slider_kinds() { return kinds_of<FlatSlider, SinglePendulum>(); }

std::span<const TermKind> stop_kinds() { return kinds_of<MerSpring, RimStop>(); }

}  // namespace rths::sim
