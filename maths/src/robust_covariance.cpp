// SPDX-License-Identifier: Apache-2.0
#include <rths/maths/robust_covariance.hpp>

#include <algorithm>
#include <cmath>

#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::maths {

Eigen::MatrixXd robust_covariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
                                  Eigen::Index lags) {
  const Eigen::Index rows = jacobian.rows(), parameters = jacobian.cols();
  // Columns of unit length: parameters of different units are then of similar size.
  const Eigen::VectorXd size = jacobian.colwise().norm();
  if (rows <= parameters || !(size.minCoeff() > 0))
    throw Error{"least squares: the record does not determine every parameter"};
  const Eigen::MatrixXd scaled = jacobian * size.cwiseInverse().asDiagonal();
  const SymmetricFactors factors{scaled.transpose() * scaled};
  if (!factors.is_positive_definite() || factors.smallest_pivot() < 1e-12)
    throw Error{"least squares: the record does not determine every parameter"};
  const Eigen::MatrixXd score = residual.asDiagonal() * scaled;
  // Bartlett's weights are those of the sums over all blocks of L + 1 rows.
  const Eigen::Index length = std::min(lags, rows - 1) + 1;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(parameters, parameters);
  Eigen::RowVectorXd block = Eigen::RowVectorXd::Zero(parameters);
  for (Eigen::Index end = 0; end < rows + length - 1; ++end) {
    if (end < rows) block += score.row(end);
    if (end >= length) block -= score.row(end - length);
    sum.noalias() += block.transpose() * block;
  }
  sum /= static_cast<double>(length);
  const Eigen::MatrixXd inverse = factors.inverse();
  const double small_sample = static_cast<double>(rows) / static_cast<double>(rows - parameters);
  const Eigen::MatrixXd covariance = small_sample * inverse * sum * inverse;
  const Eigen::VectorXd back = size.cwiseInverse();
  return back.asDiagonal() * covariance * back.asDiagonal();
}

double autocorrelation(const Eigen::VectorXd& signal, Eigen::Index lag) {
  const Eigen::VectorXd centred = signal.array() - signal.mean();
  const double energy = centred.squaredNorm();
  return energy > 0
             ? centred.head(signal.size() - lag).dot(centred.tail(signal.size() - lag)) / energy
             : 0;
}

Eigen::Index correlated_lags(const Eigen::VectorXd& residual, Eigen::Index most) {
  const double bound = kHalfWidth95 / std::sqrt(static_cast<double>(residual.size()));
  Eigen::Index lag = 1;
  while (2 * lag < most && std::abs(autocorrelation(residual, lag)) > bound) ++lag;
  return std::min(2 * lag, most);
}

}  // namespace rths::maths
