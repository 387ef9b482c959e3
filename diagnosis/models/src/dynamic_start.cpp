// SPDX-License-Identifier: Apache-2.0
#include "dynamic_start.hpp"

#include <utility>

#include <rths/identification/vectors.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {

namespace {

MatrixXd as_matrix(const SmallMatrix<double>& small) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(small.entries.data(), small.rows, small.columns);
}

// Response of the outputs to a start state of the linear system: C Φᵏ, outputs of a row together.
MatrixXd linear_response(const StepMatrices<double>& steps, int substeps, Index rows) {
  MatrixXd seen = as_matrix(steps.c);
  const MatrixXd phi = as_matrix(steps.phi);
  const Index outputs = seen.rows();
  MatrixXd response(rows * outputs, phi.rows());
  for (Index row = 0; row < rows; ++row) {
    response.middleRows(row * outputs, outputs) = seen;
    for (int substep = 0; substep < substeps; ++substep) seen = seen * phi;
  }
  return response;
}

// The change of a start state that explains a difference. State directions with little effect on
// the outputs stay as they are.
VectorXd least_change(const MatrixXd& response, const VectorXd& difference) {
  const VectorXd scale = response.colwise().norm().transpose().cwiseMax(1e-300);
  const maths::MinimumNormSolver solver{response * scale.cwiseInverse().asDiagonal(), 1e-6};
  return scale.cwiseInverse().asDiagonal() * solver.solve(difference);
}

// Gauss-Newton steps for a start state, each halved until the prediction is better.
class StartSearch {
 public:
  using Predicted = std::function<MatrixXd(const VectorXd&)>;

  StartSearch(const MatrixXd& measured, const Predicted& predicted)
      : measured_{measured}, predicted_{predicted} {}

  /// Measured minus predicted; empty if the prediction diverges.
  [[nodiscard]] VectorXd off(const VectorXd& start) const {
    const MatrixXd now = predicted_(start);
    if (now.rows() < measured_.rows()) return {};
    const MatrixXd difference = (measured_ - now.topRows(measured_.rows())).transpose();
    return Eigen::Map<const VectorXd>(difference.data(), difference.size());
  }

  /// Response to small changes of the start state, by differences; the response before where there
  /// is no prediction.
  [[nodiscard]] MatrixXd response(const VectorXd& start, const VectorXd& at,
                                  MatrixXd before) const {
    constexpr double kDifference = 1e-4;  // of the effect of the measurement's size
    const double size = measured_.norm();
    for (Index i = 0; i < start.size(); ++i) {
      const double effect = before.col(i).norm();
      if (!(effect > 0) || !(size > 0)) continue;
      const double step = kDifference * size / effect;
      VectorXd moved = start;
      moved[i] += step;
      if (const VectorXd there = off(moved); there.size() > 0) before.col(i) = (at - there) / step;
    }
    return before;
  }

  /// @returns whether a step improved the start
  bool improve(const MatrixXd& response, VectorXd& start, VectorXd& at) const {
    constexpr int kHalvings = 8;
    VectorXd step = least_change(response, at);
    for (int i = 0; i < kHalvings; ++i, step /= 2) {
      VectorXd there = off(start + step);
      if (there.size() == 0 || !(there.squaredNorm() < at.squaredNorm())) continue;
      start += step;
      at = std::move(there);
      return true;
    }
    return false;
  }

 private:
  const MatrixXd& measured_;
  const Predicted& predicted_;
};

}  // namespace

VectorXd fitted_start(const StepMatrices<double>& steps, int substeps, const MatrixXd& measured,
                      VectorXd start, const std::function<MatrixXd(const VectorXd&)>& predicted) {
  constexpr int kLinear = 3, kExact = 5;  // iterations
  if (start.size() == 0) start = VectorXd::Zero(steps.phi.rows);
  if (start.size() == 0) return start;
  const StartSearch search{measured, predicted};
  VectorXd at = search.off(start);
  if (at.size() == 0) return start;
  const MatrixXd linear = linear_response(steps, substeps, measured.rows());
  for (int i = 0; i < kLinear && search.improve(linear, start, at); ++i) continue;
  // Terms change the response: a pendulum's period grows with its swing.
  MatrixXd response = linear;
  for (int i = 0; i < kExact; ++i) {
    response = search.response(start, at, std::move(response));
    const double before = at.squaredNorm();
    if (!search.improve(response, start, at) || at.squaredNorm() > (1 - 1e-6) * before) break;
  }
  return start;
}

VectorXd state_sizes(const StepMatrices<double>& steps, int substeps, const MatrixXd& measured) {
  VectorXd sizes = linear_response(steps, substeps, measured.rows()).colwise().norm();
  for (double& size : sizes) size = size > 0 ? measured.norm() / size : 0;
  return sizes;
}

void follow_start(Index rows, const std::vector<MatrixXd>& response,
                  std::vector<MatrixXd>& derivatives) {
  const auto beginning = [&](const MatrixXd& signal) -> VectorXd {
    return signal.topRows(rows).reshaped();
  };
  MatrixXd seen(rows * response[0].cols(), std::ssize(response));
  for (Index i = 0; i < seen.cols(); ++i)
    seen.col(i) = beginning(response[static_cast<std::size_t>(i)]);
  for (auto& derivative : derivatives) {
    const VectorXd change = least_change(seen, -beginning(derivative));
    for (Index i = 0; i < seen.cols(); ++i)
      derivative += change[i] * response[static_cast<std::size_t>(i)];
  }
}

}  // namespace rths::diagnosis
