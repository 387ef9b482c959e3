// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Core>

#include <rths/algebra/decompositions.hpp>

#include "investigation.hpp"

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
    if (!supposition.evaluate(fold, hypothesis.values, all, residual, jacobian)) {
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
VectorXd scatter(const Investigation& found, const Minimum& minimum) {
  const Problem& problem = *found.problem;
  VectorXd squares = VectorXd::Zero(minimum.inverse.rows());
  const std::size_t count = problem.draws(0).size();
  for (std::size_t k = 0; k < count; ++k) {
    VectorXd noise(minimum.jacobian.rows());
    Index first = 0;
    for (const auto& share : found.folds.both.shares) {
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

std::vector<Estimate> estimates_of(const Investigation& found) {
  const Problem& problem = *found.problem;
  const Hypothesis& named = found.selection.named;
  const Minimum minimum{problem, found.folds.both, named};
  VectorXd variance = VectorXd::Zero(named.values.size());
  if (minimum.exists()) {
    constexpr double kBlock = 1.5;  // [s]
    const auto block = static_cast<Index>(kBlock / problem.drive(0).time_step) + 1;
    const double mean_square =
        std::max(1.0, minimum.residual.squaredNorm() /
                          std::max(1.0, observations(problem, found.folds.both)));
    variance = sandwich(minimum.jacobian, minimum.residual, minimum.inverse, block)
                   .diagonal()
                   .cwiseMax(mean_square * minimum.inverse.diagonal())
                   .cwiseMax(scatter(found, minimum));
    variance = (minimum.alone.array() > 0).select(mean_square * minimum.alone, variance);
  }
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < named.free.size(); ++i) {
    constexpr double kNormal95 = 1.96;
    const auto at = static_cast<Index>(i);
    const FreeParameter& free = named.free[i];
    const double value = named.values[at];
    const double half = free.scale * kNormal95 * std::sqrt(std::max(0.0, variance[at]));
    estimates.push_back({free.name, free.unit, value, std::max(value - half, free.low),
                         std::min(value + half, free.high)});
  }
  return estimates;
}

}  // namespace rths::diagnosis
