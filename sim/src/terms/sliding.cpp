// SPDX-License-Identifier: Apache-2.0
#include "sliding.hpp"

#include <vector>

namespace rths::sim {
namespace {

// States of a slider: displacement before, friction force.
enum { kBefore, kFrictionState = 2, kSliderStates = 4 };

// Advances a slider's friction by one step. In uplift the friction force is zero.
template <class Real>
Plane<Real> friction(const TermView<Real>& term, const Quantities<Real>& q, const Real& stiffness,
                     const Real& yield) {
  const Plane<Real> u{q.displacement[0], q.displacement[1]};
  Plane<Real> force{term.state[kFrictionState], term.state[kFrictionState + 1]};
  slide(force, u - Plane<Real>{term.state[kBefore], term.state[kBefore + 1]}, stiffness, yield);
  term.state[kBefore] = u.x, term.state[kBefore + 1] = u.y;
  term.state[kFrictionState] = force.x, term.state[kFrictionState + 1] = force.y;
  return force;
}

template <class Real>
void add(const Plane<Real>& hysteretic, const Real& stiffness, Quantities<Real>& q) {
  q.hysteretic_force[0] += hysteretic.x, q.hysteretic_force[1] += hysteretic.y;
  q.force[0] += hysteretic.x + stiffness * q.displacement[0];
  q.force[1] += hysteretic.y + stiffness * q.displacement[1];
}

struct FlatSlider {
  static constexpr std::string_view kName = "flat_slider";
  static constexpr std::string_view kTitle = "flat slider";
  static constexpr std::string_view kEquation = "F = k0 (u - u_p),  |F| <= mu N,  N = max(0, load)";
  static constexpr std::string_view kSource =
      "Constantinou, Mokha & Reinhorn 1990; step of Krieg & Krieg 1977";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative | kFrameIndifferent;
  enum { kCoefficient, kStiffness };
  static constexpr Parameter kParameters[] = {{"friction_coefficient", "-", 0, 1, 0, 0.1},
                                              {"initial_stiffness", "N/m", 1, 1e12, 4e8, 4e8}};
  static constexpr std::size_t kStates = kSliderStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real yield = term.parameters[kCoefficient] * q.strength * contact_load(q);
    add(friction(term, q, term.parameters[kStiffness], yield), Real{0}, q);
  }
};

struct SinglePendulum {
  static constexpr std::string_view kName = "single_pendulum";
  static constexpr std::string_view kTitle = "single friction pendulum (slider on a sphere)";
  static constexpr std::string_view kEquation =
      "F = N u/R + k0 (u - u_p),  |k0 (u - u_p)| <= mu N,  N = max(0, load)";
  static constexpr std::string_view kSource = "Zayas, Low & Mahin 1987; small slopes";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative | kFrameIndifferent;
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
    add(friction(term, q, term.parameters[kStiffness], yield), stiffness, q);
  }
};

constexpr TermKind kSliders[] = {kind_of<FlatSlider>(), kind_of<SinglePendulum>()};

}  // namespace

std::span<const TermKind> slider_kinds() { return kSliders; }

std::span<const TermKind> sliding_kinds() {
  static const std::vector<TermKind> all = [] {
    std::vector<TermKind> kinds;
    for (const auto& group : {sliding_vertical_kinds(), sliding_modifier_kinds(), slider_kinds(),
                              triple_pendulum_kinds(), stop_kinds()})
      kinds.insert(kinds.end(), group.begin(), group.end());
    return kinds;
  }();
  return all;
}

}  // namespace rths::sim
