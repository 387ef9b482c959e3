// SPDX-License-Identifier: Apache-2.0
#include <rths/diagnosis/least_squares.hpp>

#include <algorithm>
#include <cmath>

#include <ceres/ceres.h>
#include <Eigen/Cholesky>

#include <rths/core/error.hpp>

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// One block of residuals in parameters over their scale.
class Cost final : public ceres::CostFunction {
 public:
  explicit Cost(const FitProblem& problem) : problem_{problem} {
    set_num_residuals(static_cast<int>(problem.rows));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.start.size()));
  }

  bool Evaluate(double const* const* scaled, double* residuals, double** jacobians) const override {
    const Index n = problem_.start.size();
    const VectorXd parameters =
        Eigen::Map<const VectorXd>(scaled[0], n).cwiseProduct(problem_.scale);
    const bool wants_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    VectorXd residual;
    MatrixXd jacobian;
    if (!problem_.residuals(parameters, residual, wants_jacobian ? &jacobian : nullptr))
      return false;
    Eigen::Map<VectorXd>(residuals, problem_.rows) = residual;
    if (wants_jacobian)
      Eigen::Map<RowMajor>(jacobians[0], problem_.rows, n) = jacobian * problem_.scale.asDiagonal();
    return true;
  }

 private:
  const FitProblem& problem_;
};

void check(const FitProblem& p) {
  const Index n = p.start.size();
  if (n == 0 || p.low.size() != n || p.high.size() != n || p.scale.size() != n || p.rows < n)
    throw Error{"least squares: sizes do not agree"};
  if (!(p.scale.array() > 0).all()) throw Error{"least squares: a scale is not > 0"};
  if (!((p.start.array() >= p.low.array()) && (p.start.array() <= p.high.array())).all())
    throw Error{"least squares: the start lies outside the bounds"};
}

void set_bounds(const FitProblem& p, ceres::Problem& problem, double* scaled) {
  for (int i = 0; i < static_cast<int>(p.start.size()); ++i) {
    if (std::isfinite(p.low[i])) problem.SetParameterLowerBound(scaled, i, p.low[i] / p.scale[i]);
    if (std::isfinite(p.high[i])) problem.SetParameterUpperBound(scaled, i, p.high[i] / p.scale[i]);
  }
}

}  // namespace

Fit least_squares(const FitProblem& p) {
  check(p);
  VectorXd scaled = p.start.cwiseQuotient(p.scale);
  ceres::Problem problem;
  problem.AddResidualBlock(new Cost{p}, nullptr, scaled.data());  // NOLINT: Ceres takes it
  set_bounds(p, problem, scaled.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = p.most_iterations;
  options.function_tolerance = p.tolerance;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type == ceres::FAILURE) throw Error{"least squares: " + summary.message};
  Fit fit;
  fit.parameters = scaled.cwiseProduct(p.scale).cwiseMax(p.low).cwiseMin(p.high);
  if (!p.residuals(fit.parameters, fit.residual, &fit.jacobian))
    throw Error{"least squares: no residual at the result"};
  fit.sum_of_squares = fit.residual.squaredNorm();
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  return fit;
}

MatrixXd covariance(const Fit& fit, Index block) {
  const MatrixXd& J = fit.jacobian;
  const VectorXd scale = J.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const MatrixXd H = scale.asDiagonal() * (J.transpose() * J) * scale.asDiagonal();
  const Eigen::LDLT<MatrixXd> factors{H};
  constexpr double kLeastPivot = 1e-12;  // of columns of unit length
  if (!(factors.vectorD().minCoeff() > kLeastPivot))
    throw Error{"covariance: the parameters cannot be told apart"};
  const MatrixXd inverse = scale.asDiagonal() *
                           factors.solve(MatrixXd::Identity(H.rows(), H.cols())) *
                           scale.asDiagonal();
  const double mean_square =
      fit.sum_of_squares / static_cast<double>(std::max<Index>(1, J.rows() - J.cols()));
  MatrixXd meat = MatrixXd::Zero(J.cols(), J.cols());
  for (Index first = 0; first < J.rows(); first += block) {
    const Index size = std::min(block, J.rows() - first);
    const VectorXd g = J.middleRows(first, size).transpose() * fit.residual.segment(first, size);
    meat += g * g.transpose();
  }
  MatrixXd sandwich = inverse * meat * inverse;
  const VectorXd plain = std::max(1.0, mean_square) * inverse.diagonal();
  const VectorXd growth = plain.cwiseQuotient(sandwich.diagonal()).cwiseMax(1).cwiseSqrt();
  return growth.asDiagonal() * sandwich * growth.asDiagonal();
}

}  // namespace rths::diagnosis
