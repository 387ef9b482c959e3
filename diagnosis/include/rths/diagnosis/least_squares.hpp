// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Core>

namespace rths::diagnosis {

/// Residuals at some parameters, and how they change with them.
/// @param jacobian  ∂residual/∂parameter, rows × parameters; null where it is not wanted
/// @returns false if there is no residual at these parameters
using Residuals = std::function<bool(const Eigen::VectorXd& parameters, Eigen::VectorXd& residual,
                                     Eigen::MatrixXd* jacobian)>;

/// Where a fit may go and when it has arrived.
struct FitProblem {
  Residuals residuals;
  Eigen::Index rows = 0;      ///< of the residual
  Eigen::VectorXd start;      ///< inside the bounds
  Eigen::VectorXd low, high;  ///< bounds; ±infinity: none
  Eigen::VectorXd scale;      ///< size of each parameter, > 0: makes them alike
  int most_iterations = 20;
  double tolerance = 1e-6;  ///< on the relative change of the sum of squares [-]
};

/// Result of a fit.
struct Fit {
  Eigen::VectorXd parameters;
  double sum_of_squares = 0;
  Eigen::MatrixXd jacobian;  ///< at `parameters`
  Eigen::VectorXd residual;  ///< at `parameters`
  bool converged = false;
};

/// Least squares with bounds, by Levenberg-Marquardt: each step is the least of the quadratic model
/// within the bounds, so that parameters which only together are determined may lie on one.
/// @throws Error if the sizes do not agree, or there is no residual at the start   @setup
[[nodiscard]] Fit least_squares(const FitProblem& problem);

/// The sandwich H⁻¹ G H⁻¹ (White 1980): G is Jᵀr rᵀJ, summed over blocks of rows that remember each
/// other.
/// @param inverse  H⁻¹ of JᵀJ   @param block  rows   @setup
[[nodiscard]] Eigen::MatrixXd sandwich(const Eigen::MatrixXd& jacobian,
                                       const Eigen::VectorXd& residual,
                                       const Eigen::MatrixXd& inverse, Eigen::Index block);

/// Covariance of fitted parameters whose residuals need be neither white nor of variance 1: the
/// sandwich, or H⁻¹ times the mean square, whichever is larger in each parameter's variance.
/// @param block  rows   @throws Error if the parameters cannot be told apart   @setup
[[nodiscard]] Eigen::MatrixXd covariance(const Fit& fit, Eigen::Index block);

}  // namespace rths::diagnosis
