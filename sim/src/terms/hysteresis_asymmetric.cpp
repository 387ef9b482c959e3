// SPDX-License-Identifier: Apache-2.0
#include "hysteresis.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

// The device is attached to a slipping anchor p. Its deflection y = u - p is bounded by the play
// and the elastic length. The force is a function of y, so the solution is exact.
struct AsymmetricHysteresis : Acts<Stage::Restoring, kDissipative | kPerAxis> {
  static constexpr std::string_view kName = "asymmetric_hysteresis";
  static constexpr std::string_view kTitle = "asymmetric friction of a device with play";
  static constexpr std::string_view kEquation =
      "F = F_+ (y - g/2)/L_+ for y > g/2, F_- (y + g/2)/L_- for y < -g/2, else 0,  "
      "dy = du within -L_- - g/2 ... L_+ + g/2";
  static constexpr std::string_view kSource =
      "stop operator, Visintin 1994; the play before it is ours";
  enum { kForward, kBackward, kForwardLength, kBackwardLength, kPlay };
  static constexpr Parameter kParameters[] = {{"forward_force", "N", 0, 1e9, 0, 1e5},
                                              {"backward_force", "N", 0, 1e9, 0, 1.5e5},
                                              {"forward_length", "m", 1e-9, 1, 3e-3, 3e-3},
                                              {"backward_length", "m", 1e-9, 1, 3e-3, 4e-3},
                                              {"play", "m", 0, 1, 0, 5e-3}};
  static constexpr std::size_t kStates =
      std::size_t{2} * kHorizontalAxes;  // displacement before, y

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real* p = term.parameters;
    const Real half = 0.5 * p[kPlay];
    for_each_active_axis(term, [&](std::size_t axis) {
      Real& before = term.state[2 * axis];
      Real& y = term.state[2 * axis + 1];
      y += q.displacement[axis] - before;
      before = q.displacement[axis];
      // A weaker device slips earlier with the same stiffness.
      const Real most = half + p[kForwardLength] * q.strength;
      const Real least = -half - p[kBackwardLength] * q.strength;
      if (y > most) y = most;
      if (y < least) y = least;
      if (!(y > half || y < -half)) return;
      const Real force = y > half ? Real{p[kForward] / p[kForwardLength] * (y - half)}
                                  : Real{p[kBackward] / p[kBackwardLength] * (y + half)};
      q.hysteretic_force[axis] += force;
      q.force[axis] += force;
    });
  }
};

}  // namespace

std::span<const TermKind> asymmetric_kinds() { return kinds_of<AsymmetricHysteresis>(); }

}  // namespace rths::sim
