// SPDX-License-Identifier: Apache-2.0
#include <rths/maths/decompositions.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <unsupported/Eigen/MatrixFunctions>

namespace rths::maths {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd solve_symmetric(const MatrixXd& a, const VectorXd& b) { return a.ldlt().solve(b); }

MatrixXd solve_symmetric(const MatrixXd& a, const MatrixXd& b) { return a.ldlt().solve(b); }

SymmetricFactors::SymmetricFactors(const MatrixXd& a) : factors_{a} {}

VectorXd SymmetricFactors::solve(const VectorXd& b) const { return factors_.solve(b); }

MatrixXd SymmetricFactors::inverse() const {
  return factors_.solve(MatrixXd::Identity(factors_.rows(), factors_.cols()));
}

double SymmetricFactors::smallest_pivot() const {
  return factors_.vectorD().minCoeff<Eigen::PropagateNaN>();
}

bool SymmetricFactors::is_positive_definite() const {
  return factors_.info() == Eigen::Success && factors_.isPositive() && smallest_pivot() > 0;
}

MatrixXd inverse(const MatrixXd& a) { return a.inverse(); }

VectorXd solve_least_squares(const MatrixXd& a, const VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

MatrixXd solve_least_squares(const MatrixXd& a, const MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

MinimumNormSolver::MinimumNormSolver(const MatrixXd& a, double threshold) {
  if (threshold >= 0) factors_.setThreshold(threshold);
  factors_.compute(a);
}

VectorXd MinimumNormSolver::solve(const VectorXd& b) const { return factors_.solve(b); }

MatrixXd MinimumNormSolver::pseudo_inverse() const { return factors_.pseudoInverse(); }

Eigen::Index MinimumNormSolver::rank() const { return factors_.rank(); }

Modes symmetric_modes(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> modes{a};
  return {modes.eigenvalues(), modes.eigenvectors()};
}

Modes generalized_modes(const MatrixXd& k, const MatrixXd& m) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes{k, m};
  return {modes.eigenvalues(), modes.eigenvectors()};
}

MatrixXd exponential(const MatrixXd& a) { return a.exp(); }

}  // namespace rths::maths
