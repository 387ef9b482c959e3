// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/screening.hpp>

#include <algorithm>
#include <numeric>
#include <optional>

#include <rths/identification/constants.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {
namespace {

struct Score {
  double gain;
  VectorXd start;
};

// The gain of the best combination of columns, beyond the base's parameters; 0 if a single
// parameter would leave its bound `low`.
double gain_of(MatrixXd columns, const Complement& complement, const VectorXd& residual,
               double absent, double low) {
  const VectorXd whole = columns.colwise().norm();
  for (Index i = 0; i < columns.cols(); ++i) complement.take_out(columns.col(i));
  const VectorXd length = columns.colwise().norm();
  std::vector<Index> used;
  for (Index i = 0; i < columns.cols(); ++i)
    if (length[i] > kOwnShare * whole[i]) used.push_back(i);
  if (used.empty()) return 0;
  const MatrixXd unit = columns(Eigen::all, used) * length(used).cwiseInverse().asDiagonal();
  const VectorXd weights = maths::solve_least_squares(unit, residual);
  // A size that may only grow explains nothing with the wrong sign.
  if (columns.cols() == 1 && absent - weights[0] / length[used[0]] < low) return 0;
  return 0.5 * (residual.squaredNorm() - (residual - unit * weights).squaredNorm());
}

// Residual of the base on a fold, and the part of it that the fitted parameters cannot reproduce.
struct BaseResidual {
  const TestedHypothesis& base;
  const Fold& fold;
  const Complement& complement;
  VectorXd whole, rest;
};

// Gain of a candidate from one start; none if there is no prediction.
std::optional<double> gain_at(const BaseResidual& residual, const Candidate& candidate,
                              const VectorXd& start) {
  const Hypothesis& hypothesis = residual.base.hypothesis();
  const TestedHypothesis beside{residual.base, extended(hypothesis, candidate, start)};
  std::vector<Index> added(beside.hypothesis().free.size() - hypothesis.free.size());
  std::iota(added.begin(), added.end(), static_cast<Index>(hypothesis.free.size()));
  // A candidate that only widens a tolerance of the base is hidden by it.
  if (added.empty() || candidate.is_hidden) return kUnknownGain;
  VectorXd there;
  MatrixXd columns;
  if (!beside.evaluate(residual.fold, beside.hypothesis().values, added, there, columns))
    return std::nullopt;
  const double low = candidate.frees[0].low;
  const double absent = candidate.adds.empty() ? start[0] : std::max(0.0, low);
  const double gain = gain_of(std::move(columns), residual.complement, residual.rest, absent,
                              low == 0 ? low : -kUnbounded);
  if (!(low > 0)) return gain;
  // An effect with a threshold has no slope at its absence, so the whole effect is tried as well.
  return std::max(
      gain, gain_of(there - residual.whole, residual.complement, residual.rest, 0, -kUnbounded));
}

// Hidden candidates count as the best.
void sort_by_gain(std::vector<Screened>& candidates) {
  double best = 0;
  for (const auto& screened : candidates) best = std::max(best, screened.gain);
  for (auto& screened : candidates)
    if (screened.gain == kUnknownGain) screened.gain = best;
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Screened& a, const Screened& b) { return a.gain > b.gain; });
}

}  // namespace

Complement::Complement(const MatrixXd& columns) {
  if (columns.cols() == 0) return;
  MatrixXd scaled = columns;
  for (Index i = 0; i < scaled.cols(); ++i) {
    const double length = scaled.col(i).norm();
    if (length > 0) scaled.col(i) /= length;
  }
  // By the small Gram matrix, because the columns are long and few.
  const maths::Modes eigen = maths::symmetric_modes(scaled.transpose() * scaled);
  const VectorXd& values = eigen.values;
  const double least = kRankCut * values[values.size() - 1];
  std::vector<Index> used;
  for (Index i = 0; i < values.size(); ++i)
    if (values[i] > least) used.push_back(i);
  basis_ = scaled * eigen.vectors(Eigen::all, used) *
           values(used).cwiseSqrt().cwiseInverse().asDiagonal();
}

void Complement::take_out(Eigen::Ref<VectorXd> x) const {
  if (basis_.cols() > 0) x -= basis_ * (basis_.transpose() * x);
}

std::vector<Screened> screen(const TestedHypothesis& given, const Fold& fold,
                             const std::vector<Candidate>& candidates) {
  const Hypothesis& hypothesis = given.hypothesis();
  TestedHypothesis base{given.problem(), hypothesis};
  base.keep(fold);
  const std::vector<Index> all = movable_of(hypothesis);
  VectorXd whole;
  MatrixXd jacobian;
  std::vector<Screened> result;
  if (!base.evaluate(fold, hypothesis.values, all, whole, jacobian)) return result;
  const Complement complement{jacobian};
  BaseResidual residual{base, fold, complement, whole, whole};
  complement.take_out(residual.rest);
  for (const auto& candidate : candidates) {
    std::vector<Score> scores;
    for (const auto& start : candidate.starts)
      if (const auto gain = gain_at(residual, candidate, start)) scores.push_back({*gain, start});
    if (scores.empty()) continue;
    std::stable_sort(scores.begin(), scores.end(),
                     [](const Score& a, const Score& b) { return a.gain > b.gain; });
    Screened screened{&candidate, {}, scores[0].gain};
    for (const auto& score : scores) screened.starts.push_back(score.start);
    result.push_back(std::move(screened));
  }
  sort_by_gain(result);
  return result;
}

}  // namespace rths::diagnosis
