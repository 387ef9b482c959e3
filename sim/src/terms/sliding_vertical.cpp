// SPDX-License-Identifier: Apache-2.0
#include "sliding.hpp"

namespace rths::sim {
namespace {

struct PendulumLift {
  static constexpr std::string_view kName = "pendulum_lift";
  static constexpr std::string_view kTitle = "lift of a pendulum bearing";
  static constexpr std::string_view kEquation = "w = w - |u|^2/(2 R),  dw/dt = dw/dt - u.v/R";
  static constexpr std::string_view kSource = "sphere, small slopes";
  static constexpr Stage kStage = Stage::Vertical;
  static constexpr unsigned kTraits = kFrameIndifferent;
  enum { kRadius };
  static constexpr Parameter kParameters[] = {{"effective_radius", "m", 0, 100, 0, 4}};  // 0: flat

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real& radius = term.parameters[kRadius];
    if (!(radius > 0)) return;
    const Plane<Real> u{q.displacement[0], q.displacement[1]};
    // The slider climbs, so the same distance between the plates compresses it more.
    q.vertical_displacement -= dot(u, u) / (2 * radius);
    q.vertical_velocity -= dot(u, Plane<Real>{q.velocity[0], q.velocity[1]}) / radius;
  }
};

struct MultilinearAxial {
  static constexpr std::string_view kName = "multilinear_axial";
  static constexpr std::string_view kTitle = "multilinear elastic and viscous axial spring";
  static constexpr std::string_view kEquation =
      "N += K1 e + (K2 - K1) max(0, e - e1) + (K3 - K2) max(0, e - e2) + c de/dt >= 0,  e = -w > "
      "0; "
      "K_t e in tension";
  static constexpr std::string_view kSource = "paper's axial model; corners ours";
  static constexpr Stage kStage = Stage::Vertical;
  static constexpr unsigned kTraits = kPlain;
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

constexpr TermKind kSlidingVerticalKinds[] = {kind_of<PendulumLift>(), kind_of<MultilinearAxial>()};

}  // namespace

std::span<const TermKind> sliding_vertical_kinds() { return kSlidingVerticalKinds; }

}  // namespace rths::sim
