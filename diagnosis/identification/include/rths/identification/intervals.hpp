// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <rths/identification/selection.hpp>
#include <rths/identification/vectors.hpp>

namespace rths::diagnosis {

/// A fitted parameter with its 95 % confidence interval.
struct Estimate {
  std::string name;  ///< "coulomb_friction_long.friction_force"
  std::string unit;  ///< SI
  double value = 0, low = 0, high = 0;
  std::optional<double> absent = {};  ///< value without any effect; none: not a size
};

/// Covariance of the free parameters of a hypothesis that was fitted to a fold, in their units. It
/// includes scatter and bias by noise in the measured motion, and systematic errors of the
/// prediction of up to kMaterial.
/// @param inflation  smallest ratio of standard deviations to those of white noise alone
/// @returns zero if there is no prediction
[[nodiscard]] MatrixXd covariance_of(const Problem& problem, const Fold& fold,
                                     const Hypothesis& fitted, double inflation = 1);

/// Every free parameter with its interval, which ends at the bounds.
/// @param covariance  of the free parameters
[[nodiscard]] std::vector<Estimate> estimates_of(const Hypothesis& fitted,
                                                 const MatrixXd& covariance);

/// Whether a free parameter ended at one of its bounds.
/// @param tolerance  of the parameter's scale
[[nodiscard]] bool is_on_bound(const Hypothesis& hypothesis, Index i, double tolerance);

/// Whether all sizes of a candidate together may have the values of no effect: Wald's test at 5 %
/// (Wald 1943). Its other parameters count as known, at the price of their degrees of freedom.
/// False for a candidate without sizes.
/// @param covariance  of the free parameters of `fitted`, which contain those of the candidate
[[nodiscard]] bool may_be_absent(const Candidate& candidate, const Hypothesis& fitted,
                                 const MatrixXd& covariance);

/// Root mean square difference of the parameters that the two folds prefer, over its deviation in
/// white noise (Birge 1932); at least 1. More than 1: the form of the model is not quite right, and
/// each fold compensates for that in its own way.
[[nodiscard]] double fold_disagreement(const Problem& problem, const Folds& folds,
                                       const Hypothesis& fitted);

/// Indices of free parameters whose whole effect on a fold the others can cause.
[[nodiscard]] std::vector<Index> undetermined(const Problem& problem, const Fold& fold,
                                              const Hypothesis& fitted);

}  // namespace rths::diagnosis
