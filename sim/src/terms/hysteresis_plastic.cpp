// SPDX-License-Identifier: Apache-2.0
#include "hysteresis_kinds.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

struct Bilinear {
  static constexpr std::string_view kName = "bilinear";
  static constexpr std::string_view kTitle = "bilinear hysteresis";
  static constexpr std::string_view kEquation =
      "F = K_d u + Q_d z,  dz = du/u_y within |z| < 1, radial return to |z| = 1";
  static constexpr std::string_view kSource = "Simo & Hughes 1998, chapter 1, in the plane";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative | kFrameIndifferent;
  enum { kStrength, kStiffness, kYieldDisplacement };
  static constexpr Parameter kParameters[] = {
      {"characteristic_strength", "N", 0, 1e9, 0, 1e6},
      {"post_yield_stiffness", "N/m", 0, 1e12, 0, 4e6},
      {"yield_displacement", "m", 1e-7, 1, 2.855e-3, 2.855e-3}};
  static constexpr std::size_t kStates = 4;  // displacement before, z

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Plane<Real> increment = scaled_increment(q, term.state);
    Plane<Real> z = Plane<Real>{term.state[2], term.state[3]} +
                    increment * (1 / term.parameters[kYieldDisplacement]);
    const Real radius = length(z);
    if (radius > 1) z = z * (1 / radius);
    term.state[2] = z.x, term.state[3] = z.y;
    resist(q, z * (term.parameters[kStrength] * q.strength),
           term.parameters[kStiffness] * q.stiffness);
  }
};

constexpr TermKind kPlasticKinds[] = {kind_of<Bilinear>()};

}  // namespace

std::span<const TermKind> plastic_kinds() { return kPlasticKinds; }

}  // namespace rths::sim
