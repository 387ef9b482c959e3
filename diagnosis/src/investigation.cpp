// SPDX-License-Identifier: Apache-2.0
#include "investigation.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "forms.hpp"

namespace rths::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool Investigation::is_unknown() const {
  constexpr double kExplained = 0.85;
  if (!selection.has_remainder() || (is_named() && selection.explained() >= kExplained))
    return false;
  // Noise that is a little larger than it was at rest (by less than 0.2, where nothing is missing)
  // is no physics: it must have a form.
  constexpr double kPlain = 0.25, kFormShare = 0.3;
  const double rest = selection.variance_named - 1;
  return rest > kPlain || (!descriptions.empty() && descriptions[0].share > kFormShare);
}

std::unique_ptr<Investigation> investigate(std::unique_ptr<Relation> relation, const Case& c,
                                           const SensorNoise& noise, std::uint64_t seed) {
  auto found = std::make_unique<Investigation>();
  found->relation = std::move(relation);
  found->noise = &noise;
  found->seed = seed;
  found->split = split_of(c);
  found->first = *found->split.records[0];
  found->problem = std::make_unique<Problem>(*found->relation, found->split.records, noise, seed);
  found->folds = folds_of(found->split, *found->problem);
  found->selection = select(*found->problem, found->folds, seed);
  if (found->selection.has_remainder())
    found->descriptions =
        describe(Supposition{*found->problem, found->selection.named}, found->folds);
  if (!found->split.held.empty()) {
    found->proof = std::make_unique<Problem>(*found->relation, found->split.held, noise, seed + 1);
    found->proof->renew_noise(found->selection.named);
  }
  return found;
}

double nrmse(const Problem& problem, std::size_t record, const Hypothesis& hypothesis) {
  const MatrixXd prediction = Supposition{problem, hypothesis}.prediction(record);
  const Drive& drive = problem.drive(record);
  if (prediction.size() == 0) return std::nan("");
  const Index rows = drive.rows() - drive.first_row;
  MatrixXd error = (drive.measured - prediction).bottomRows(rows);
  MatrixXd measured = drive.measured.bottomRows(rows);
  error.rowwise() -= error.colwise().mean().eval();
  measured.rowwise() -= measured.colwise().mean().eval();
  return error.norm() / measured.norm();
}

RecordScore score_of(const Investigation& found, const Problem& problem, std::size_t record) {
  const Selection& selection = found.selection;
  const Record& one = problem.record(record);
  RecordScore score;
  score.record = one.name;
  score.use = one.use == Use::Fit ? "fit" : "held_out";
  score.nrmse_before = nrmse(problem, record, selection.base);
  score.nrmse_after = nrmse(problem, record, selection.named);
  score.nrmse_stated = nrmse(problem, record, found.relation->base());
  const Drive& drive = problem.drive(record);
  MatrixXd measured = drive.measured;
  measured.rowwise() -= measured.colwise().mean().eval();
  double noise = 0;
  for (const auto& draw : problem.draws(record))
    noise += (draw.rowwise() - draw.colwise().mean()).squaredNorm() /
             static_cast<double>(problem.draws(record).size());
  score.noise_floor = std::sqrt(noise) / measured.norm();
  const Fold fold = whole({record});
  score.variance_before = Supposition{problem, selection.base}.variance(fold);
  score.variance_after = Supposition{problem, selection.named}.variance(fold);
  return score;
}

bool is_on_bound(const Hypothesis& hypothesis, Index i) {
  const FreeParameter& free = hypothesis.free[static_cast<std::size_t>(i)];
  const double value = hypothesis.values[i], near = 1e-9 * (free.high - free.low);
  return value <= free.low + near || value >= free.high - near;
}

std::vector<Estimate> estimates_of(const Investigation& found, const Step& step) {
  const Problem& problem = *found.problem;
  const Hypothesis& named = found.selection.named;
  const Supposition supposition{problem, named};
  std::vector<Index> all(named.free.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
  Fit fit;
  fit.parameters = named.values;
  VectorXd variance = VectorXd::Zero(named.values.size());
  if (supposition.evaluate(found.folds.both, named.values, all, fit.residual, fit.jacobian)) {
    fit.sum_of_squares = fit.residual.squaredNorm();
    VectorXd scale(named.values.size());
    for (std::size_t i = 0; i < named.free.size(); ++i)
      scale[static_cast<Index>(i)] = named.free[i].scale;
    fit.jacobian = fit.jacobian * scale.asDiagonal();
    // What lies on a bound does not move with the others.
    VectorXd own = VectorXd::Zero(scale.size());
    for (Index i = 0; i < scale.size(); ++i) {
      if (!is_on_bound(named, i)) continue;
      own[i] = 1 / std::max(fit.jacobian.col(i).squaredNorm(), 1e-300);
      fit.jacobian.col(i).setZero();
    }
    constexpr double kBlock = 1.5;  // [s]
    const auto block = static_cast<Index>(kBlock / problem.drive(0).time_step) + 1;
    // Parameters that the records do not fix get the width of what is allowed.
    MatrixXd normal = fit.jacobian.transpose() * fit.jacobian;
    normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff();
    const MatrixXd inverse = normal.inverse();
    MatrixXd meat = MatrixXd::Zero(normal.rows(), normal.cols());
    for (Index first = 0; first < fit.jacobian.rows(); first += block) {
      const Index size = std::min(block, fit.jacobian.rows() - first);
      const VectorXd g =
          fit.jacobian.middleRows(first, size).transpose() * fit.residual.segment(first, size);
      meat += g * g.transpose();
    }
    const double mean_square =
        std::max(1.0, fit.sum_of_squares / std::max(1.0, observations(problem, found.folds.both)));
    variance = (inverse * meat * inverse).diagonal().cwiseMax(mean_square * inverse.diagonal());
    // The noise of the measured motion, which is in the residual and in what predicts it: one
    // Gauss-Newton step for each draw.
    MatrixXd steps = MatrixXd::Zero(normal.rows(), 0);
    for (std::size_t k = 0; k < problem.draws(0).size(); ++k) {
      VectorXd noise(fit.jacobian.rows());
      Index first = 0;
      for (const auto& share : found.folds.both.shares) {
        const auto& draws = problem.draws(share.record);
        const MatrixXd white =
            problem.noise(share.record).whitened(draws[std::min(k, draws.size() - 1)]);
        noise.segment(first, white.size()) = Eigen::Map<const VectorXd>(white.data(), white.size());
        first += white.size();
      }
      steps.conservativeResize(Eigen::NoChange, steps.cols() + 1);
      steps.col(steps.cols() - 1) = inverse * (fit.jacobian.transpose() * noise);
    }
    variance = variance.cwiseMax(steps.rowwise().squaredNorm() /
                                 static_cast<double>(std::max<Index>(1, steps.cols())));
    for (Index i = 0; i < scale.size(); ++i)
      if (own[i] > 0) variance[i] = mean_square * own[i];
    variance = variance.cwiseProduct(scale.cwiseAbs2());
  }
  std::vector<Estimate> estimates;
  for (const auto& wanted : step.chosen.candidate.frees)
    for (std::size_t i = 0; i < named.free.size(); ++i) {
      if (named.free[i].name != wanted.name) continue;
      constexpr double kNormal95 = 1.96;
      const double value = named.values[static_cast<Index>(i)];
      const double half = kNormal95 * std::sqrt(std::max(0.0, variance[static_cast<Index>(i)]));
      estimates.push_back({wanted.name, wanted.unit, value,
                           std::max(value - half, named.free[i].low),
                           std::min(value + half, named.free[i].high)});
    }
  return estimates;
}

}  // namespace rths::diagnosis
