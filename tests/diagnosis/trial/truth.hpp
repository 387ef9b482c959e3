// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "place.hpp"
#include "trial_case.hpp"

namespace trial {

inline constexpr double kDetectable = 25;       ///< information from which an effect can be seen
inline constexpr double kDistinguishable = 12;  ///< separation from which a rival is not it

/// How far the nearest that a rival can come stays away from an effect. Of a rival that is far off
/// it is an upper bound: only its sizes were free.
struct Separation {
  std::string_view rival;
  double nats = 0;
  bool contains_it = false;  ///< the effect is a special case: the fewer parameters win
};

/// What there is to be found of one effect, on the fit record.
struct EffectTruth {
  double energy = 0;       ///< ½‖e‖²: recorded with minus without, at the same motion [nat]
  double information = 0;  ///< ½‖e⊥‖²: what the nuisances cannot make [nat]
  std::vector<Separation> separations;  ///< nearest first
  Place of_effect, of_rest;             ///< where e and e⊥ are
  [[nodiscard]] bool detectable() const { return information >= kDetectable; }
};

/// @param with_rivals  they take most of the time
EffectTruth truth_of(const TrialCase& trial, const Effect& effect, bool with_rivals);

/// Errors of a force that is computed from the measured motion, offset removed, over the standard
/// deviation of the measured force: on the unseen record, parameters fitted to the other two.
struct Floor {
  double oracle = 0;   ///< the laboratory's own model, with the effects
  double without = 0;  ///< the same without them
  double nominal = 0;  ///< the simulation as it is stated, nothing fitted
};

Floor floor_of(const TrialCase& trial);

/// Parameters of an effect that a fit can move.
std::vector<Parameter> fitted_parameters(const Effect& effect);

}  // namespace trial
