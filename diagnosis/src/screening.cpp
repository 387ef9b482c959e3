// SPDX-License-Identifier: Apache-2.0
#include "screening.hpp"

#include <algorithm>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRankCut = 1e-6;  // of the largest singular value of columns of unit length

constexpr double kUnbounded = 1e300;
constexpr double kUnknown = -1;  // gain: as good as the best

struct Score {
  double gain;
  VectorXd start;
};

// The gain of the best combination of columns; none if it would have to go where it may not.
double gain_of(const MatrixXd& columns, const VectorXd& residual, double absent, double low) {
  const VectorXd length = columns.colwise().norm();
  std::vector<Index> used;
  for (Index i = 0; i < columns.cols(); ++i)
    if (length[i] > 1e-9 * residual.norm()) used.push_back(i);
  if (used.empty()) return 0;
  const MatrixXd unit = columns(Eigen::all, used) * length(used).cwiseInverse().asDiagonal();
  const VectorXd weights = unit.colPivHouseholderQr().solve(residual);
  // Of a size that may only grow, the wrong sign explains nothing.
  if (columns.cols() == 1 && absent - weights[0] / length[used[0]] < low) return 0;
  return 0.5 * (residual.squaredNorm() - (residual - unit * weights).squaredNorm());
}

}  // namespace

Complement::Complement(const MatrixXd& columns) {
  if (columns.cols() == 0) return;
  MatrixXd scaled = columns;
  for (Index i = 0; i < scaled.cols(); ++i) {
    const double length = scaled.col(i).norm();
    if (length > 0) scaled.col(i) /= length;
  }
  // Through the small Gram matrix: the columns are long and few.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen{scaled.transpose() * scaled};
  const VectorXd values = eigen.eigenvalues();
  const double least = kRankCut * values[values.size() - 1];
  std::vector<Index> used;
  for (Index i = 0; i < values.size(); ++i)
    if (values[i] > least) used.push_back(i);
  basis_ = scaled * eigen.eigenvectors()(Eigen::all, used) *
           values(used).cwiseSqrt().cwiseInverse().asDiagonal();
}

void Complement::take_out(Eigen::Ref<VectorXd> x) const {
  if (basis_.cols() > 0) x -= basis_ * (basis_.transpose() * x);
}

std::vector<Screened> screen(const Supposition& base, const Fold& fold,
                             const std::vector<Candidate>& candidates) {
  const Hypothesis& hypothesis = base.hypothesis();
  std::vector<Index> all(hypothesis.free.size());
  std::iota(all.begin(), all.end(), Index{0});
  VectorXd residual;
  MatrixXd jacobian;
  std::vector<Screened> result;
  if (!base.evaluate(fold, hypothesis.values, all, residual, jacobian)) return result;
  const Complement complement{jacobian};
  const VectorXd raw = residual;
  complement.take_out(residual);
  for (const auto& candidate : candidates) {
    std::vector<Score> scores;
    for (const auto& start : candidate.starts) {
      const Supposition beside{base.problem(), extended(hypothesis, candidate, start)};
      std::vector<Index> added(beside.hypothesis().free.size() - all.size());
      std::iota(added.begin(), added.end(), static_cast<Index>(all.size()));
      // What only widens a tolerance of the base is hidden by it: a fit must tell.
      if (added.empty() || candidate.is_hidden) {
        scores.push_back({kUnknown, start});
        continue;
      }
      VectorXd there;
      MatrixXd columns;
      if (!beside.evaluate(fold, beside.hypothesis().values, added, there, columns)) continue;
      for (Index i = 0; i < columns.cols(); ++i) complement.take_out(columns.col(i));
      const double low = candidate.frees[0].low;
      const double absent = candidate.adds.empty() ? start[0] : std::max(0.0, low);
      double gain = gain_of(columns, residual, absent, low == 0 ? low : -kUnbounded);
      // What sets in at a threshold does not begin with its slope there.
      if (low > 0) {
        MatrixXd whole_effect = there - raw;
        complement.take_out(whole_effect.col(0));
        gain = std::max(gain, gain_of(whole_effect, residual, 0, -kUnbounded));
      }
      scores.push_back({gain, start});
    }
    if (scores.empty()) continue;
    std::stable_sort(scores.begin(), scores.end(),
                     [](const Score& a, const Score& b) { return a.gain > b.gain; });
    Screened screened{&candidate, {}, scores[0].gain};
    for (const auto& score : scores) screened.starts.push_back(score.start);
    result.push_back(std::move(screened));
  }
  double best = 0;
  for (const auto& screened : result) best = std::max(best, screened.gain);
  for (auto& screened : result)
    if (screened.gain == kUnknown) screened.gain = best;
  std::stable_sort(result.begin(), result.end(),
                   [](const Screened& a, const Screened& b) { return a.gain > b.gain; });
  return result;
}

}  // namespace rths::diagnosis
