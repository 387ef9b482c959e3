// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Core>

namespace rths::diagnosis {

/// Residuals at given parameters, and their derivatives.
/// @param jacobian  ∂residual/∂parameter, rows × parameters; null: not computed
/// @returns false if there is no residual at these parameters
using Residuals = std::function<bool(const Eigen::VectorXd& parameters, Eigen::VectorXd& residual,
                                     Eigen::MatrixXd* jacobian)>;

/// A bounded least-squares problem and its stopping rule.
struct FitProblem {
  Residuals residuals;
  Eigen::Index rows = 0;      ///< of the residual
  Eigen::VectorXd start;      ///< inside the bounds
  Eigen::VectorXd low, high;  ///< bounds; ±infinity: none
  Eigen::VectorXd scale;      ///< of each parameter, > 0: normalises it, up to its bounds' distance
  int most_iterations = 20;
  double tolerance = 1e-6;     ///< on the relative change of the sum of squares [-]
  bool wants_jacobian = true;  ///< of the result
};

/// Result of a fit.
struct Fit {
  Eigen::VectorXd parameters;
  double sum_of_squares = 0;
  Eigen::MatrixXd jacobian;  ///< at `parameters`, if it is wanted and exists there
  Eigen::VectorXd residual;  ///< at `parameters`
  bool converged = false;
};

/// Bounded least squares by Levenberg-Marquardt. Each iteration minimises the quadratic model
/// within the bounds, so one of several correlated parameters may lie on a bound.
/// @throws Error if the sizes do not agree, or there is no residual at the start   @setup
[[nodiscard]] Fit least_squares(const FitProblem& problem);

/// The sandwich H⁻¹ G H⁻¹ (White 1980). G is the sum of Jᵀr rᵀJ over blocks of correlated rows.
/// @param inverse  H⁻¹ of JᵀJ   @param block  rows   @setup
[[nodiscard]] Eigen::MatrixXd sandwich(const Eigen::MatrixXd& jacobian,
                                       const Eigen::VectorXd& residual,
                                       const Eigen::MatrixXd& inverse, Eigen::Index block);

/// Covariance of fitted parameters. The residuals need be neither white nor of variance 1. Each
/// parameter's variance is the larger of two: the sandwich, and H⁻¹ times the mean square.
/// @param block  rows   @throws Error if the parameters are not identifiable   @setup
[[nodiscard]] Eigen::MatrixXd covariance(const Fit& fit, Eigen::Index block);

}  // namespace rths::diagnosis
