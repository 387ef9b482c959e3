// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/QR>

/// Decompositions of dense matrices of run-time size, compiled once: instantiating one of Eigen's
/// costs each source that uses it 3 to 10 s. All functions allocate.   @setup
namespace rths::maths {

/// x of A x = b by LDLᵀ with pivoting. @param a  symmetric, semi-definite, n × n
[[nodiscard]] Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
[[nodiscard]] Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// LDLᵀ with pivoting of a symmetric, semi-definite matrix.
class SymmetricFactors {
 public:
  explicit SymmetricFactors(const Eigen::MatrixXd& a);
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// A⁻¹.
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  /// Smallest entry of D; NaN if A holds one.
  [[nodiscard]] double smallest_pivot() const;
  [[nodiscard]] bool is_positive_definite() const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factors_;
};

/// A⁻¹ by LU with partial pivoting. @param a  regular, n × n
[[nodiscard]] Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

/// x of min |A x − b| by QR with column pivoting. @param a  m × n, m ≥ n
[[nodiscard]] Eigen::VectorXd solve_least_squares(const Eigen::MatrixXd& a,
                                                  const Eigen::VectorXd& b);
[[nodiscard]] Eigen::MatrixXd solve_least_squares(const Eigen::MatrixXd& a,
                                                  const Eigen::MatrixXd& b);

/// Shortest x of min |A x − b|, also where A lacks rank: complete orthogonal decomposition.
class MinimumNormSolver {
 public:
  /// @param threshold  pivots below it times the largest count as zero [-]; negative: Eigen's own
  explicit MinimumNormSolver(const Eigen::MatrixXd& a, double threshold = -1);
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::MatrixXd pseudo_inverse() const;
  [[nodiscard]] Eigen::Index rank() const;

 private:
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors_;
};

/// Eigenvalues in rising order and their eigenvectors, a column each.
struct Modes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
/// Of A φ = λ φ, ΦᵀΦ = I. @param a  symmetric; its lower triangle is read
[[nodiscard]] Modes symmetric_modes(const Eigen::MatrixXd& a);
/// Of K φ = λ M φ, ΦᵀMΦ = I. @param k  symmetric   @param m  symmetric, positive definite
[[nodiscard]] Modes generalized_modes(const Eigen::MatrixXd& k, const Eigen::MatrixXd& m);

/// exp(A) by scaling and squaring with Padé approximants (Higham 2005).
[[nodiscard]] Eigen::MatrixXd exponential(const Eigen::MatrixXd& a);

}  // namespace rths::maths
