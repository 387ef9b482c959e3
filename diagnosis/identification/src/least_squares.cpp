// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/least_squares.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/identification/constants.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {
namespace {

void check(const FitProblem& p) {
  const Index n = p.start.size();
  if (n == 0 || p.low.size() != n || p.high.size() != n || p.scale.size() != n || p.rows < n)
    throw Error{"least squares: sizes do not agree"};
  if (!(p.scale.array() > 0).all()) throw Error{"least squares: a scale is not > 0"};
  if (!((p.start.array() >= p.low.array()) && (p.start.array() <= p.high.array())).all())
    throw Error{"least squares: the start lies outside the bounds"};
}

// A scale far beyond the distance of the bounds would make all other parameters negligible.
VectorXd scale_within_bounds(const FitProblem& p) {
  VectorXd scale = p.scale;
  for (Index i = 0; i < scale.size(); ++i)
    if (const double span = p.high[i] - p.low[i]; span > 0) scale[i] = std::min(scale[i], span);
  return scale;
}

// A point of the fit, in parameters divided by their scales.
struct FitPoint {
  VectorXd x, residual;
  MatrixXd jacobian;
  double cost = 0;  // half the sum of squares
};

class Minimiser {
 public:
  explicit Minimiser(const FitProblem& problem)
      : problem_{problem},
        scale_{scale_within_bounds(problem)},
        low_{problem.low.cwiseQuotient(scale_)},
        high_{problem.high.cwiseQuotient(scale_)} {
    at_.x = problem.start.cwiseQuotient(scale_);
    if (!evaluate(at_, true)) throw Error{"least squares: no residual at the start"};
    has_slopes_ = true;
  }

  // @returns false if no step reduces the cost
  bool step() {
    if (!find_slopes()) return false;
    const VectorXd gradient = at_.jacobian.transpose() * at_.residual;
    const MatrixXd H = at_.jacobian.transpose() * at_.jacobian;
    for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
      FitPoint next;
      next.x = at_.x + best_step(gradient, H);
      const VectorXd way = next.x - at_.x;
      const double predicted = -(gradient.dot(way) + 0.5 * way.dot(H * way));
      if (!(predicted > problem_.tolerance * kLeastDecrease * at_.cost)) return false;
      if (evaluate(next, false) && next.cost < at_.cost) {
        const double ratio = (at_.cost - next.cost) / predicted;
        damping_ = std::clamp(ratio > 0.75   ? damping_ / 10
                              : ratio < 0.25 ? damping_ * 4
                                             : damping_,
                              kLeastDamping, kMostDamping);
        gain_ = at_.cost - next.cost;
        at_ = std::move(next);
        has_slopes_ = false;
        return true;
      }
      damping_ = std::min(damping_ * 10, kMostDamping);
    }
    return false;
  }
  [[nodiscard]] bool has_converged() const { return gain_ <= problem_.tolerance * at_.cost; }

  [[nodiscard]] Fit result(bool converged) {
    Fit fit{parameters(at_), 2 * at_.cost, {}, at_.residual, converged};
    if (problem_.wants_jacobian && find_slopes())
      fit.jacobian = at_.jacobian * scale_.cwiseInverse().asDiagonal();
    return fit;
  }

 private:
  [[nodiscard]] VectorXd parameters(const FitPoint& point) const {
    return point.x.cwiseProduct(scale_).cwiseMax(problem_.low).cwiseMin(problem_.high);
  }

  // The Jacobian of the present point, which costs as much as many residuals, only when it is used.
  bool find_slopes() {
    has_slopes_ = has_slopes_ || evaluate(at_, true);
    return has_slopes_;
  }

  bool evaluate(FitPoint& point, bool wants_jacobian) const {
    stop_if_interrupted();
    if (!problem_.residuals(parameters(point), point.residual,
                            wants_jacobian ? &point.jacobian : nullptr))
      return false;
    if (wants_jacobian) point.jacobian *= scale_.asDiagonal();
    point.cost = point.residual.squaredNorm() / 2;
    return std::isfinite(point.cost) && (!wants_jacobian || point.jacobian.allFinite());
  }

  // Minimum of the damped quadratic model within the bounds. The parameter that exceeds its bound
  // most is fixed on the bound, and the others are solved for again.
  [[nodiscard]] VectorXd best_step(const VectorXd& gradient, const MatrixXd& H) const {
    const Index n = gradient.size();
    const double largest = std::max(H.diagonal().maxCoeff(), 1e-300);
    MatrixXd damped = H;
    damped.diagonal() += damping_ * H.diagonal().cwiseMax(1e-12 * largest);
    VectorXd way = VectorXd::Zero(n);
    std::vector<Index> free = free_parameters(gradient);
    while (!free.empty()) {
      // `way` of the fixed parameters is known.
      const VectorXd pull = gradient + damped * fixed_part(way, free);
      const VectorXd solution =
          maths::solve_symmetric(MatrixXd{damped(free, free)}, VectorXd{-pull(free)});
      way(free) = solution;
      Index worst = -1;
      double excess = 0;
      for (std::size_t k = 0; k < free.size(); ++k) {
        const Index i = free[k];
        const double beyond = std::max(low_[i] - at_.x[i] - way[i], at_.x[i] + way[i] - high_[i]);
        if (beyond > excess) excess = beyond, worst = static_cast<Index>(k);
      }
      if (worst < 0) break;
      const Index i = free[static_cast<std::size_t>(worst)];
      way[i] = (at_.x[i] + way[i] < low_[i] ? low_[i] : high_[i]) - at_.x[i];
      free.erase(free.begin() + worst);
    }
    return way;
  }
  // Parameters that are not on a bound and pushed against it.
  [[nodiscard]] std::vector<Index> free_parameters(const VectorXd& gradient) const {
    std::vector<Index> free;
    for (Index i = 0; i < gradient.size(); ++i) {
      const bool is_held =
          (at_.x[i] <= low_[i] && gradient[i] > 0) || (at_.x[i] >= high_[i] && gradient[i] < 0);
      if (!is_held) free.push_back(i);
    }
    return free;
  }
  static VectorXd fixed_part(const VectorXd& way, const std::vector<Index>& free) {
    VectorXd fixed = way;
    for (const Index i : free) fixed[i] = 0;
    return fixed;
  }

  const FitProblem& problem_;
  VectorXd scale_, low_, high_;
  FitPoint at_;
  bool has_slopes_ = false;
  double damping_ = kFirstDamping, gain_ = 0;
};

}  // namespace

Fit least_squares(const FitProblem& p) {
  check(p);
  Minimiser minimiser{p};
  for (int i = 0; i < p.most_iterations; ++i)
    if (!minimiser.step() || minimiser.has_converged()) return minimiser.result(true);
  return minimiser.result(false);
}

MatrixXd sandwich(const MatrixXd& jacobian, const VectorXd& residual, const MatrixXd& inverse,
                  Index block) {
  MatrixXd sum = MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  for (Index first = 0; first < jacobian.rows(); first += block) {
    const Index size = std::min(block, jacobian.rows() - first);
    const VectorXd g = jacobian.middleRows(first, size).transpose() * residual.segment(first, size);
    sum += g * g.transpose();
  }
  return inverse * sum * inverse;
}

MatrixXd covariance(const Fit& fit, Index block) {
  const MatrixXd& J = fit.jacobian;
  const VectorXd scale = J.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const MatrixXd H = scale.asDiagonal() * (J.transpose() * J) * scale.asDiagonal();
  const maths::SymmetricFactors factors{H};
  if (!(factors.smallest_pivot() > kLeastPivot))
    throw Error{"covariance: the data do not separate the parameters"};
  const MatrixXd inverse = scale.asDiagonal() * factors.inverse() * scale.asDiagonal();
  const double mean_square =
      fit.sum_of_squares / static_cast<double>(std::max<Index>(1, J.rows() - J.cols()));
  const MatrixXd robust = sandwich(J, fit.residual, inverse, block);
  const VectorXd plain = std::max(1.0, mean_square) * inverse.diagonal();
  const VectorXd growth = plain.cwiseQuotient(robust.diagonal()).cwiseMax(1).cwiseSqrt();
  return growth.asDiagonal() * robust * growth.asDiagonal();
}

}  // namespace rths::diagnosis
