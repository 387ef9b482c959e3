// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/intervals.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Core>

#include <rths/algebra/decompositions.hpp>

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool is_on_bound(const Hypothesis& hypothesis, Index i) {
  const FreeParameter& free = hypothesis.free[static_cast<std::size_t>(i)];
  const double value = hypothesis.values[i], near = 1e-9 * (free.high - free.low);
  return value <= free.low + near || value >= free.high - near;
}

// Linearised fit at its minimum, in units of the parameters' scales.
struct Minimum {
  VectorXd residual;
  MatrixXd jacobian;
  MatrixXd inverse;  // of JᵀJ
  VectorXd alone;    // variance of a parameter on its bound, without the others; else 0

  Minimum(const Problem& problem, const Fold& fold, const Hypothesis& hypothesis) {
    std::vector<Index> all(hypothesis.free.size());
    std::iota(all.begin(), all.end(), Index{0});
    const Supposition supposition{problem, hypothesis};
    if (all.empty() || !supposition.evaluate(fold, hypothesis.values, all, residual, jacobian)) {
      jacobian.resize(0, 0);
      return;
    }
    alone = VectorXd::Zero(hypothesis.values.size());
    for (Index i = 0; i < alone.size(); ++i) {
      jacobian.col(i) *= hypothesis.free[static_cast<std::size_t>(i)].scale;
      if (!is_on_bound(hypothesis, i)) continue;
      alone[i] = 1 / std::max(jacobian.col(i).squaredNorm(), 1e-300);
      jacobian.col(i).setZero();
    }
    // Keeps the matrix regular; undetermined parameters get the width of their bounds.
    MatrixXd normal = jacobian.transpose() * jacobian;
    normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff();
    inverse = algebra::inverse(normal);
  }
  [[nodiscard]] bool exists() const { return jacobian.size() > 0; }
  // One Gauss-Newton step.
  [[nodiscard]] VectorXd step(const VectorXd& rows) const {
    return -inverse * (jacobian.transpose() * rows);
  }
};

// Mean squares of the parameter changes that noise draws cause, of the measured motion too.
VectorXd scatter(const Problem& problem, const Fold& fold, const Minimum& minimum) {
  VectorXd squares = VectorXd::Zero(minimum.inverse.rows());
  const std::size_t count = problem.draws(0).size();
  for (std::size_t k = 0; k < count; ++k) {
    VectorXd noise(minimum.jacobian.rows());
    Index first = 0;
    for (const auto& share : fold.shares) {
      const auto& draws = problem.draws(share.record);
      const MatrixXd white =
          problem.noise(share.record).whitened(draws[std::min(k, draws.size() - 1)]);
      noise.segment(first, white.size()) = Eigen::Map<const VectorXd>(white.data(), white.size());
      first += white.size();
    }
    squares += minimum.step(noise).cwiseAbs2() / static_cast<double>(count);
  }
  return squares;
}

}  // namespace

double fold_disagreement(const Problem& problem, const Folds& folds, const Hypothesis& fitted) {
  const Minimum one{problem, folds.first, fitted}, other{problem, folds.second, fitted};
  if (!one.exists() || !other.exists()) return 1;
  const VectorXd difference = one.step(one.residual) - other.step(other.residual);
  const double free = static_cast<double>((one.alone.array() == 0).count());
  const MatrixXd covariance = one.inverse + other.inverse;
  const double square = difference.dot(algebra::solve_symmetric(covariance, difference));
  return free > 0 && std::isfinite(square) ? std::sqrt(std::max(1.0, square / free)) : 1;
}

std::vector<Estimate> estimates_of(const Problem& problem, const Fold& fold,
                                   const Hypothesis& fitted, double inflation) {
  const Minimum minimum{problem, fold, fitted};
  VectorXd variance = VectorXd::Zero(fitted.values.size());
  if (minimum.exists()) {
    constexpr double kBlock = 1.5;  // [s]
    const auto block = static_cast<Index>(kBlock / problem.drive(0).time_step) + 1;
    const double mean_square =
        std::max(1.0, minimum.residual.squaredNorm() / std::max(1.0, observations(problem, fold)));
    variance = sandwich(minimum.jacobian, minimum.residual, minimum.inverse, block)
                   .diagonal()
                   .cwiseMax(mean_square * minimum.inverse.diagonal())
                   .cwiseMax(inflation * inflation * minimum.inverse.diagonal())
                   .cwiseMax(scatter(problem, fold, minimum));
    variance = (minimum.alone.array() > 0).select(mean_square * minimum.alone, variance);
  }
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < fitted.free.size(); ++i) {
    constexpr double kNormal95 = 1.96;
    const auto at = static_cast<Index>(i);
    const FreeParameter& free = fitted.free[i];
    const double value = fitted.values[at];
    const double half = free.scale * kNormal95 * std::sqrt(std::max(0.0, variance[at]));
    estimates.push_back({free.name, free.unit, value, std::max(value - half, free.low),
                         std::min(value + half, free.high)});
  }
  return estimates;
}

}  // namespace rths::diagnosis
