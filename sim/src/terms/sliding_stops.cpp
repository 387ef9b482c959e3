// SPDX-License-Identifier: Apache-2.0
#include "sliding.hpp"

namespace rths::sim {
namespace {

struct RimStop {
  static constexpr std::string_view kName = "rim_stop";
  static constexpr std::string_view kTitle = "contact with the rim";
  static constexpr std::string_view kEquation =
      "F = k g (1 + a dg/dt) u/|u|,  g = |u| - d,  no pull";
  static constexpr std::string_view kSource = "Hunt & Crossley 1975, exponent 1";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative | kFrameIndifferent;
  enum { kStiffness, kClearance, kLoss };
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m", 0, 1e15, 0, 1e8},
                                              {"clearance", "m", 0, 10, 1, 0.12},
                                              {"loss", "s/m", 0, 100, 0, 0.5}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Plane<Real> u{q.displacement[0], q.displacement[1]};
    const Real radius = length(u);
    const Real depth = radius - term.parameters[kClearance];
    if (!(depth > 0) || !(radius > 0)) return;
    const Real rate = dot(u, Plane<Real>{q.velocity[0], q.velocity[1]}) / radius;
    const Real push = term.parameters[kStiffness] * depth * (1 + term.parameters[kLoss] * rate);
    if (!(push > 0)) return;
    q.force[0] += push * u.x / radius;
    q.force[1] += push * u.y / radius;
  }
};

struct MerSpring {
  static constexpr std::string_view kName = "mer_spring";
  static constexpr std::string_view kTitle = "pair of compression-only springs on each axis";
  static constexpr std::string_view kEquation = "F = K (max(0, u - gap) - max(0, -u - gap))";
  static constexpr std::string_view kSource = "EradiQuake: mass energy regulators; linear";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative | kPerAxis;
  enum { kStiffness, kGap };
  // A negative gap is a precompression: near the middle both springs push.
  static constexpr Parameter kParameters[] = {{"stiffness", "N/m", 0, 1e15, 0, 1.2e7},
                                              {"gap", "m", -1, 1, 0, 0.01}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      const Real& u = q.displacement[axis];
      const Real& gap = term.parameters[kGap];
      const Real stiffness = term.parameters[kStiffness] * q.stiffness;
      if (u > gap) q.force[axis] += stiffness * (u - gap);
      if (-u > gap) q.force[axis] += stiffness * (u + gap);
    });
  }
};

constexpr TermKind kStopKinds[] = {kind_of<MerSpring>(), kind_of<RimStop>()};

}  // namespace

std::span<const TermKind> stop_kinds() { return kStopKinds; }

}  // namespace rths::sim
