// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// A fitted parameter with its 95 % confidence interval.
struct Estimate {
  std::string name;  ///< "coulomb_friction_long.friction_force"
  std::string unit;  ///< SI
  double value = 0, low = 0, high = 0;
};

/// Every free parameter of a hypothesis that was fitted to a fold, with its interval. The interval
/// includes the effect of noise in the measured motion.
/// @param inflation  smallest ratio of standard deviations to those of white noise alone
[[nodiscard]] std::vector<Estimate> estimates_of(const Problem& problem, const Fold& fold,
                                                 const Hypothesis& fitted, double inflation = 1);

/// Root mean square difference of the parameters that the two folds prefer, over its deviation in
/// white noise (Birge 1932); at least 1. More than 1: the form of the model is not quite right, and
/// each fold compensates for that in its own way.
[[nodiscard]] double fold_disagreement(const Problem& problem, const Folds& folds,
                                       const Hypothesis& fitted);

}  // namespace rths::diagnosis
