// SPDX-License-Identifier: Apache-2.0
#include "kinds.hpp"

namespace rths::sim {
namespace {

struct CoulombFriction {
  static constexpr std::string_view kName = "coulomb_friction";
  static constexpr std::string_view kTitle = "Coulomb friction with presliding";
  static constexpr std::string_view kEquation = "F = F_c s,  ds = (du - s |du|) / z_s";
  static constexpr std::string_view kSource = "Dahl 1968, exponent 1";
  static constexpr Stage kStage = Stage::Machine;
  static constexpr unsigned kTraits = kDissipative | kPerAxis;
  enum { kForce, kPresliding };
  static constexpr Parameter kParameters[] = {{"friction_force", "N", 0, 1e7, 0, 1e4},
                                              {"presliding", "m", 1e-7, 0.1, 1e-4, 1e-4}};
  static constexpr std::size_t kStates = 2 * kHorizontalAxes;  // displacement before, s

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    using std::abs;
    using std::exp;
    for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis) {
      if (!term.acts_on(axis)) continue;
      Real& before = term.state[2 * axis];
      Real& s = term.state[2 * axis + 1];
      const Real du = q.displacement[axis] - before;
      // The law is solved exactly along a step that does not turn.
      const Real sign = du > 0 ? Real{1} : Real{-1};
      s = sign + (s - sign) * exp(-abs(du) / term.parameters[kPresliding]);
      before = q.displacement[axis];
      q.force[axis] += term.parameters[kForce] * s;
    }
  }
};

struct ViscousFriction {
  static constexpr std::string_view kName = "viscous_friction";
  static constexpr std::string_view kTitle = "viscous friction";
  static constexpr std::string_view kEquation = "F = c v";
  static constexpr std::string_view kSource = "";
  static constexpr Stage kStage = Stage::Machine;
  static constexpr unsigned kTraits = kDissipative | kPerAxis;
  static constexpr Parameter kParameters[] = {{"damping", "N*s/m", 0, 1e7, 0, 1e4}};
  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis)
      if (term.acts_on(axis)) q.force[axis] += term.parameters[0] * q.velocity[axis];
  }
};

constexpr TermKind kKinds[] = {kind_of<CoulombFriction>(), kind_of<ViscousFriction>()};

}  // namespace

std::span<const TermKind> machine_kinds() { return kKinds; }

}  // namespace rths::sim
