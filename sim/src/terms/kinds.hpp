// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <rths/sim/term.hpp>

namespace rths::sim {

using Text = std::string_view;

// A term is a struct with its description as constants and its physics as a template over the
// number type:
//     struct CoulombFriction : Acts<Stage::Machine, kDissipative | kPerAxis> {
//       static constexpr Text kName = "coulomb_friction", kTitle, kEquation, kSource;
//       enum { kForce, kPresliding };                        // indices into
//       static constexpr Parameter kParameters[] = {…};      // its parameters
//       static constexpr std::size_t kStates = 2;            // or size(const TermSetup&)
//       static void prepare(const TermSetup&, std::span<double> constants);  // if it has constants
//       static void step(const auto& term, auto& q);         // TermView<Real>, Quantities<Real>
//       // or the force that it adds on each axis on which it acts:
//       static auto force(const auto& term, const auto& q, std::size_t axis);
//     };

/// Stage and traits of a term, and its usual source.
template <Stage stage, unsigned traits = kPlain>
struct Acts {
  static constexpr Stage kStage = stage;
  static constexpr unsigned kTraits = traits;
  static constexpr Text kSource = "textbook";  // unless the term names another
};

template <class Term>
TermSize size_of(const TermSetup& setup) {
  if constexpr (requires { Term::size(setup); })
    return Term::size(setup);
  else if constexpr (requires { Term::kStates; })
    return {Term::kStates, 0};
  else
    return {};
}

template <class Term>
void prepare_of(const TermSetup& setup, std::span<double> constants) {
  if constexpr (requires { Term::prepare(setup, constants); }) Term::prepare(setup, constants);
}

/// Calls `act(axis)` for each horizontal axis that the term acts on, long first.   @realtime
template <class Real, class Act>
void for_each_active_axis(const TermView<Real>& term, Act act) {
  for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis)
    if (term.acts_on(axis)) act(axis);
}

template <class Term, class Real>
void step_of(const TermView<Real>& term, Quantities<Real>& q) noexcept {
  if constexpr (requires { Term::force(term, q, std::size_t{}); })
    for_each_active_axis(term,
                         [&](std::size_t axis) { q.force[axis] += Term::force(term, q, axis); });
  else
    Term::step(term, q);
}

template <class Term>
constexpr TermKind kind_of() {
  return {Term::kName,       Term::kTitle,           Term::kEquation,     Term::kSource,
          Term::kStage,      Term::kTraits,          Term::kParameters,   &size_of<Term>,
          &prepare_of<Term>, &step_of<Term, double>, &step_of<Term, Dual>};
}

template <class... Terms>
std::span<const TermKind> kinds_of() {
  static constexpr TermKind kKinds[] = {kind_of<Terms>()...};
  return kKinds;
}

/// x within ±limit.
template <class Real>
Real clipped(const Real& x, const Real& limit) {
  if (x > limit) return limit;
  if (x < -limit) return -limit;
  return x;
}

// The kinds of each file, in the order in which they act within a stage.
std::span<const TermKind> actuator_kinds();
std::span<const TermKind> elastomeric_vertical_kinds();
std::span<const TermKind> elastomeric_modifier_kinds();
std::span<const TermKind> lead_heating_kinds();
std::span<const TermKind> elastomeric_restoring_kinds();
std::span<const TermKind> bouc_wen_kinds();
std::span<const TermKind> hysteresis_kinds();
std::span<const TermKind> controlled_kinds();
std::span<const TermKind> sliding_vertical_kinds();
std::span<const TermKind> sliding_modifier_kinds();
std::span<const TermKind> slider_kinds();
std::span<const TermKind> triple_pendulum_kinds();
std::span<const TermKind> stop_kinds();
std::span<const TermKind> mount_kinds();
std::span<const TermKind> spring_kinds();
std::span<const TermKind> friction_kinds();
std::span<const TermKind> sensor_kinds();

}  // namespace rths::sim
