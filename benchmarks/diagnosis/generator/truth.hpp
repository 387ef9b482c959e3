// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "place.hpp"
#include "trial_case.hpp"

namespace trial {

inline constexpr double kDetectable = 25;  ///< least information of a detectable effect [nat]
inline constexpr double kDistinguishable =
    12;  ///< least separation from a distinguishable rival [nat]

/// Distance of an effect from the best fit of a rival. For a distant rival it is an upper bound,
/// because only the rival's sizes were fitted.
struct Separation {
  std::string_view rival;
  double nats = 0;
  bool contains_it = false;  ///< the effect is a special case of the rival and has fewer parameters
};

/// Detectable information on one effect, on the fit record.
struct EffectTruth {
  double energy = 0;       ///< ½‖e‖²: recorded with minus without, at the same motion [nat]
  double information = 0;  ///< ½‖e⊥‖²: beyond the nuisance parameters [nat]
  std::vector<Separation> separations;  ///< nearest first
  Place of_effect, of_rest;             ///< of e and e⊥
  [[nodiscard]] bool detectable() const { return information >= kDetectable; }
};

/// @param with_rivals  computes separations, which take most of the time
EffectTruth truth_of(const TrialCase& trial, const Effect& effect, bool with_rivals);

/// Error of the force computed from the measured motion on the unseen record, with the parameters
/// fitted to the other two records. The offset is removed, and the error divided by the standard
/// deviation of the measured force.
struct Floor {
  double oracle = 0;   ///< the laboratory's model with the effects
  double without = 0;  ///< the same model without the effects
  double nominal = 0;  ///< the stated simulation, without a fit
};

Floor floor_of(const TrialCase& trial);

/// Parameters of an effect that a fit can change.
std::vector<Parameter> fitted_parameters(const Effect& effect);

}  // namespace trial
