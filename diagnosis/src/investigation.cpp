// SPDX-License-Identifier: Apache-2.0
#include "investigation.hpp"

#include <algorithm>
#include <cmath>

#include "forms.hpp"

namespace rths::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool Investigation::is_unknown() const {
  constexpr double kExplained = 0.85;
  if (!selection.has_remainder() || (is_named() && selection.explained() >= kExplained))
    return false;
  // Noise may exceed its level at rest (by less than 0.2 in cases where nothing is missing). So a
  // small excess counts only if it has a form.
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

double nrmse(const Supposition& supposition, std::size_t record) {
  const MatrixXd prediction = supposition.prediction(record);
  const Drive& drive = supposition.problem().drive(record);
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
  const Supposition before{problem, selection.base}, after{problem, selection.named};
  score.nrmse_before = nrmse(before, record);
  score.nrmse_after = nrmse(after, record);
  score.nrmse_stated = nrmse(Supposition{problem, found.relation->base()}, record);
  const Drive& drive = problem.drive(record);
  MatrixXd measured = drive.measured;
  measured.rowwise() -= measured.colwise().mean().eval();
  double noise = 0;
  for (const auto& draw : problem.draws(record))
    noise += (draw.rowwise() - draw.colwise().mean()).squaredNorm() /
             static_cast<double>(problem.draws(record).size());
  score.noise_floor = std::sqrt(noise) / measured.norm();
  const Fold fold = whole({record});
  score.variance_before = before.variance(fold);
  score.variance_after = after.variance(fold);
  return score;
}

}  // namespace rths::diagnosis
