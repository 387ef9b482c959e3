// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <type_traits>

#include <rths/sim/term.hpp>

namespace rths::sim {

// A term is a struct with its description as constants and its physics as a template over the
// number type:
//     struct CoulombFriction {
//       static constexpr std::string_view kName = "coulomb_friction", kTitle, kEquation, kSource;
//       static constexpr Stage kStage = Stage::Machine;
//       static constexpr unsigned kTraits = kDissipative | kPerAxis;
//       enum { kForce, kPresliding };                        // indices into
//       static constexpr Parameter kParameters[] = {…};      // its parameters
//       static constexpr std::size_t kStates = 2;            // or size(const TermSetup&)
//       static void prepare(const TermSetup&, std::span<double> constants);  // if it has constants
//       template <class Real>
//       static void step(const TermView<Real>& term, Quantities<Real>& q);
//     };
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

template <class Term, class Real>
void step_of(const TermView<Real>& term, Quantities<Real>& q) noexcept {
  Term::step(term, q);
}

template <class Term>
constexpr TermKind kind_of() {
  return {Term::kName,       Term::kTitle,           Term::kEquation,     Term::kSource,
          Term::kStage,      Term::kTraits,          Term::kParameters,   &size_of<Term>,
          &prepare_of<Term>, &step_of<Term, double>, &step_of<Term, Dual>};
}

/// Calls `act(axis)` for each horizontal axis that the term acts on, long first.   @realtime
template <class Real, class Act>
void for_each_active_axis(const TermView<Real>& term, Act act) {
  for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis)
    if (term.acts_on(axis)) act(axis);
}

std::span<const TermKind> actuator_kinds();
std::span<const TermKind> elastomeric_kinds();
std::span<const TermKind> hysteresis_kinds();
std::span<const TermKind> machine_kinds();
std::span<const TermKind> sensor_kinds();
std::span<const TermKind> sliding_kinds();

}  // namespace rths::sim
