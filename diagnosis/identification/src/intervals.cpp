// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/intervals.hpp>

#include <algorithm>
#include <cmath>

#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::diagnosis {
namespace {

constexpr double kSameValue = 1e-6;  // of a parameter's scale
constexpr double kHeld = 1e-300;     // variance of a parameter that may not change

// (JᵀJ)⁻¹. A parameter that the residual does not determine gets a large variance.
MatrixXd inverse_of_normal(const MatrixXd& jacobian) {
  MatrixXd normal = jacobian.transpose() * jacobian;
  const double least = std::max(1e-18 * normal.diagonal().maxCoeff(), 1e-200);
  const VectorXd length = normal.diagonal().cwiseMax(least).cwiseSqrt();
  const auto unit = length.cwiseInverse().asDiagonal();
  normal = unit * normal * unit;
  normal.diagonal().array() += 1e-9;
  return unit * maths::inverse(normal) * unit;
}

// Linearised fit at its minimum, in units of the parameters' scales.
struct Minimum {
  VectorXd residual;
  MatrixXd jacobian;
  MatrixXd inverse;  // of JᵀJ
  VectorXd bound;    // variance that a parameter on its bound had without it; of others 0

  Minimum(const Problem& problem, const Fold& fold, const Hypothesis& hypothesis) {
    const std::vector<Index> all = all_of(hypothesis);
    const TestedHypothesis tested{problem, hypothesis};
    if (all.empty() || !tested.evaluate(fold, hypothesis.values, all, residual, jacobian)) {
      jacobian.resize(0, 0);
      return;
    }
    for (Index i = 0; i < jacobian.cols(); ++i)
      jacobian.col(i) *= hypothesis.free[static_cast<std::size_t>(i)].scale;
    inverse = inverse_of_normal(jacobian);
    bound = VectorXd::Zero(jacobian.cols());
    for (Index i = 0; i < bound.size(); ++i) {
      if (!is_on_bound(hypothesis, i, kSameValue)) continue;
      const FreeParameter& free = hypothesis.free[static_cast<std::size_t>(i)];
      bound[i] = free.low < free.high ? inverse(i, i) : kHeld;
      jacobian.col(i).setZero();
    }
    if ((bound.array() > 0).any()) inverse = inverse_of_normal(jacobian);
  }
  [[nodiscard]] bool exists() const { return jacobian.size() > 0; }
  // Whether the other parameters can cause all of the effect of one.
  [[nodiscard]] bool is_undetermined(Index i) const {
    return inverse(i, i) * jacobian.col(i).squaredNorm() > kLargestInflation;
  }
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

// Change of the parameters that noise in the measured motion causes beyond the first order: it
// weakens what depends on the motion. More noise of the same size adds as much again (Cook &
// Stefanski 1994).
VectorXd bias(const Problem& problem, const Fold& fold, const Hypothesis& fitted,
              const Minimum& minimum) {
  VectorXd mean = VectorXd::Zero(minimum.inverse.rows());
  const bool is_exact = problem.relation().runs_freely() || problem.draws(0).empty();
  const std::size_t count = is_exact ? 0 : kBiasDraws;
  for (std::size_t k = 0; k < count; ++k) {
    const Minimum disturbed{problem.disturbed(k), fold, fitted};
    if (!disturbed.exists()) return VectorXd::Zero(mean.size());
    mean += (disturbed.step(disturbed.residual) - minimum.step(disturbed.residual)) /
            static_cast<double>(count);
  }
  return mean;
}

// Standard deviations of the parameters if the prediction has an error that is equally likely up to
// kMaterial and of the form of each parameter's own effect, with the others fitted again. Zero for
// a parameter without an effect of its own, which has the variance of the ridge.
VectorXd systematic(const Problem& problem, const Fold& fold, const Hypothesis& fitted,
                    const Minimum& minimum) {
  VectorXd result = VectorXd::Zero(minimum.inverse.rows());
  for (Index i = 0; i < result.size(); ++i) {
    if (minimum.is_undetermined(i)) continue;
    VectorXd way = minimum.inverse.col(i);
    way *= kLargestMove / std::max(way.cwiseAbs().maxCoeff(), 1e-300);
    Hypothesis moved = fitted;
    for (Index k = 0; k < way.size(); ++k)
      moved.values[k] += way[k] * fitted.free[static_cast<std::size_t>(k)].scale;
    const double change = change_of(problem, fitted, moved, fold);
    if (change > 0) result[i] = std::abs(way[i]) * kMaterial / change / std::sqrt(3.0);
  }
  return result;
}

// Of a covariance; a parameter without variance has no correlations.
MatrixXd correlation_of(const MatrixXd& covariance) {
  const VectorXd deviation = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  MatrixXd correlation =
      deviation.cwiseInverse().asDiagonal() * covariance * deviation.cwiseInverse().asDiagonal();
  correlation.diagonal().setOnes();
  return correlation;
}

// 95 % quantile of chi-square; beyond the table, that of the last entry.
double chi_square_95(std::size_t degrees) {
  return kChiSquare95[std::min(degrees, kChiSquare95.size()) - 1];
}

}  // namespace

bool is_on_bound(const Hypothesis& hypothesis, Index i, double tolerance) {
  const FreeParameter& free = hypothesis.free[static_cast<std::size_t>(i)];
  const double value = hypothesis.values[i], near = tolerance * free.scale;
  return value <= free.low + near || value >= free.high - near;
}

double fold_disagreement(const Problem& problem, const Folds& folds, const Hypothesis& fitted) {
  const Minimum one{problem, folds.first, fitted}, other{problem, folds.second, fitted};
  if (!one.exists() || !other.exists()) return 1;
  const VectorXd difference = one.step(one.residual) - other.step(other.residual);
  const double free = static_cast<double>((one.bound.array() == 0).count());
  const MatrixXd covariance = one.inverse + other.inverse;
  const double square = difference.dot(maths::solve_symmetric(covariance, difference));
  return free > 0 && std::isfinite(square) ? std::sqrt(std::max(1.0, square / free)) : 1;
}

std::vector<Index> undetermined(const Problem& problem, const Fold& fold,
                                const Hypothesis& fitted) {
  const Minimum minimum{problem, fold, fitted};
  std::vector<Index> indices;
  for (Index i = 0; minimum.exists() && i < minimum.jacobian.cols(); ++i)
    if (minimum.bound[i] == 0 && minimum.is_undetermined(i)) indices.push_back(i);
  return indices;
}

MatrixXd covariance_of(const Problem& problem, const Fold& fold, const Hypothesis& fitted,
                       double inflation) {
  const Index count = fitted.values.size();
  const Minimum minimum{problem, fold, fitted};
  if (!minimum.exists()) return MatrixXd::Zero(count, count);
  const Index block =
      std::max(kLeastCluster, static_cast<Index>(kClusterBlock / problem.drive(0).time_step) + 1);
  const double mean_square =
      std::max(1.0, minimum.residual.squaredNorm() / std::max(1.0, observations(problem, fold)));
  VectorXd variance = sandwich(minimum.jacobian, minimum.residual, minimum.inverse, block)
                          .diagonal()
                          .cwiseMax(mean_square * minimum.inverse.diagonal())
                          .cwiseMax(inflation * inflation * minimum.inverse.diagonal())
                          .cwiseMax(scatter(problem, fold, minimum));
  variance = (minimum.bound.array() > 0).select(mean_square * minimum.bound, variance);
  variance += bias(problem, fold, fitted, minimum).cwiseAbs2();
  variance += systematic(problem, fold, fitted, minimum).cwiseAbs2();
  VectorXd scale(count);
  for (Index i = 0; i < count; ++i) scale[i] = fitted.free[static_cast<std::size_t>(i)].scale;
  const VectorXd deviation = scale.cwiseProduct(variance.cwiseMax(0).cwiseSqrt());
  return deviation.asDiagonal() * correlation_of(minimum.inverse) * deviation.asDiagonal();
}

std::vector<Estimate> estimates_of(const Hypothesis& fitted, const MatrixXd& covariance) {
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < fitted.free.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const FreeParameter& free = fitted.free[i];
    const double value = fitted.values[at], half = maths::kNormal95 * std::sqrt(covariance(at, at));
    estimates.push_back({free.name, free.unit, value, std::max(value - half, free.low),
                         std::min(value + half, free.high)});
  }
  return estimates;
}

bool may_be_absent(const Candidate& candidate, const Hypothesis& fitted,
                   const MatrixXd& covariance) {
  std::vector<Index> own, sizes;  // sizes: places in `own`
  std::vector<double> distances;  // from no effect, in standard deviations
  for (const auto& free : candidate.frees) {
    const auto found = std::find_if(fitted.free.begin(), fitted.free.end(),
                                    [&](const auto& other) { return other.name == free.name; });
    if (found == fitted.free.end()) continue;
    const Index at = found - fitted.free.begin();
    if (free.absent) {
      sizes.push_back(std::ssize(own));
      distances.push_back((fitted.values[at] - *free.absent) /
                          std::max(std::sqrt(covariance(at, at)), 1e-300));
    }
    own.push_back(at);
  }
  if (sizes.empty()) return false;
  MatrixXd correlation = correlation_of(covariance(own, own));
  correlation.diagonal().array() += 1e-9;  // keeps it regular
  const MatrixXd precision = maths::inverse(correlation);
  const Eigen::Map<const VectorXd> distance(distances.data(), std::ssize(distances));
  return distance.dot(precision(sizes, sizes) * distance) < chi_square_95(own.size());
}

}  // namespace rths::diagnosis
