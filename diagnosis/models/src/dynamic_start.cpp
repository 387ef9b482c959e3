// SPDX-License-Identifier: Apache-2.0
#include "dynamic_start.hpp"

#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {

VectorXd fitted_start(const StepMatrices<double>& steps, int substeps, const MatrixXd& measured,
                      Index rows, const std::function<MatrixXd(const VectorXd&)>& predicted) {
  constexpr int kIterations = 3;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto as_matrix = [](const SmallMatrix<double>& small) {
    return MatrixXd{Eigen::Map<const RowMajor>(small.entries.data(), small.rows, small.columns)};
  };
  const Index n = steps.phi.rows, outputs = measured.cols();
  VectorXd start = VectorXd::Zero(n);
  if (n == 0) return start;
  // Response of the outputs to a start state: C Φᵏ.
  MatrixXd response(rows * outputs, n), seen = as_matrix(steps.c);
  const MatrixXd phi = as_matrix(steps.phi);
  for (Index row = 0; row < rows; ++row) {
    response.middleRows(row * outputs, outputs) = seen;
    for (int substep = 0; substep < substeps; ++substep) seen = seen * phi;
  }
  // State directions with little effect on the outputs stay at rest.
  VectorXd scale = response.colwise().norm().transpose().cwiseMax(1e-300);
  const maths::MinimumNormSolver solver{response * scale.cwiseInverse().asDiagonal(), 1e-6};
  for (int i = 0; i < kIterations; ++i) {
    const MatrixXd now = predicted(start);
    if (now.rows() < rows) break;
    VectorXd off(rows * outputs);
    for (Index row = 0; row < rows; ++row)
      off.segment(row * outputs, outputs) = (measured.row(row) - now.row(row)).transpose();
    start += scale.cwiseInverse().asDiagonal() * solver.solve(off);
  }
  return start;
}

}  // namespace rths::diagnosis
