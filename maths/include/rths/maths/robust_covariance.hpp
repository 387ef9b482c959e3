// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace rths::maths {

/// A value and the half width of its 95 % interval, in the same unit.
struct RobustEstimate {
  double value = 0, half_width = 0;
};

/// Covariance of least-squares parameters whose residual is correlated in time: H⁻¹ S H⁻¹, with
/// H = JᵀJ and S = Σ_k (1 − |k|/(L+1)) Σ_t s_t s_{t+k}ᵀ, s_t = J_t e_t, |k| ≤ L. It is scaled by
/// n/(n − p). Source: Newey & West (1987), Econometrica 55(3):703–708.
/// @param jacobian  n × p   @param residual  n   @param lags  L ≥ 0
/// @throws Error if the parameters are not determined   @setup
[[nodiscard]] Eigen::MatrixXd robust_covariance(const Eigen::MatrixXd& jacobian,
                                                const Eigen::VectorXd& residual, Eigen::Index lags);

/// Lags over which a residual is correlated: twice the first lag whose correlation does not exceed
/// the 95 % bound of white noise, at most `most`.   @setup
[[nodiscard]] Eigen::Index correlated_lags(const Eigen::VectorXd& residual, Eigen::Index most);

/// Correlation of a signal with itself `lag` samples later, about its mean [-].   @setup
[[nodiscard]] double autocorrelation(const Eigen::VectorXd& signal, Eigen::Index lag);

}  // namespace rths::maths
