// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <rths/identification/vectors.hpp>

namespace rths::diagnosis {

/// Residuals at given parameters, and their derivatives.
/// @param jacobian  ∂residual/∂parameter, rows × parameters; null: not computed
/// @returns false if there is no residual at these parameters
using Residuals =
    std::function<bool(const VectorXd& parameters, VectorXd& residual, MatrixXd* jacobian)>;

/// A bounded least-squares problem and its stopping rule.
struct FitProblem {
  Residuals residuals;
  Index rows = 0;      ///< of the residual
  VectorXd start;      ///< inside the bounds
  VectorXd low, high;  ///< bounds; ±infinity: none
  VectorXd scale;      ///< of each parameter, > 0: normalises it, up to its bounds' distance
  int most_iterations = 20;
  double tolerance = 1e-6;     ///< on the relative change of the sum of squares [-]
  bool wants_jacobian = true;  ///< of the result
};

/// Result of a fit.
struct Fit {
  VectorXd parameters;
  double sum_of_squares = 0;
  MatrixXd jacobian;  ///< at `parameters`, if it is wanted and exists there
  VectorXd residual;  ///< at `parameters`
  bool converged = false;
};

/// Bounded least squares by Levenberg-Marquardt. Each iteration minimises the quadratic model
/// within the bounds, so one of several correlated parameters may lie on a bound.
/// @throws Error if the sizes do not agree, or there is no residual at the start   @setup
[[nodiscard]] Fit least_squares(const FitProblem& problem);

/// The sandwich H⁻¹ G H⁻¹ (White 1980). G is the sum of Jᵀr rᵀJ over blocks of correlated rows.
/// @param inverse  H⁻¹ of JᵀJ   @param block  rows   @setup
[[nodiscard]] MatrixXd sandwich(const MatrixXd& jacobian, const VectorXd& residual,
                                const MatrixXd& inverse, Index block);

/// Covariance of fitted parameters. The residuals need be neither white nor of variance 1. Each
/// parameter's variance is the larger of two: the sandwich, and H⁻¹ times the mean square.
/// @param block  rows   @throws Error if the parameters are not identifiable   @setup
[[nodiscard]] MatrixXd covariance(const Fit& fit, Index block);

}  // namespace rths::diagnosis
