// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/dual.hpp>
#include <rths/sim/term.hpp>

namespace rths::sim {

inline constexpr std::size_t kDahlStates =
    std::size_t{2} * kHorizontalAxes;  ///< displacement before, s
inline constexpr std::string_view kDahl = "Dahl 1968, exponent 1";
inline constexpr Parameter kPreslidingLength = {"presliding", "m", 1e-9, 1, 1e-4, 1e-4};

/// Fraction s of an axis' full friction, -1 … 1, after this step: Dahl's law with exponent 1, exact
/// for a step without reversal. The term's first states are `kDahlStates`.   @realtime
template <class Real>
const Real& presliding(const TermView<Real>& term, const Quantities<Real>& q, std::size_t axis,
                       const Real& length) {
  Real& before = term.state[2 * axis];
  Real& s = term.state[2 * axis + 1];
  const Real du = q.displacement[axis] - before;
  const Real sign = du > 0 ? Real{1} : Real{-1};
  s = sign + (s - sign) * exp(-abs(du) / length);
  before = q.displacement[axis];
  return s;
}

}  // namespace rths::sim
