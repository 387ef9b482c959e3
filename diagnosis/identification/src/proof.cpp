// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/proof.hpp>

#include <algorithm>
#include <cmath>

#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::diagnosis {
namespace {

// Energy of the compared rows about their mean, by output.
ArrayXd energy_about_mean(const Drive& drive, const MatrixXd& signal) {
  return energy_of(drive.compared_rows(signal), true);
}

RecordScore score_of(const TestedHypothesis& before, const TestedHypothesis& after,
                     const Zeros& zeros, std::size_t record) {
  const Problem& problem = after.problem();
  const Fold fold = compared(problem, {record});
  RecordScore score;
  score.record = problem.record(record).name;
  score.nrmse_before = nrmse(before, record, zeros);
  score.nrmse_after = nrmse(after, record, zeros);
  score.nrmse_stated = nrmse({problem, problem.relation().base()}, record, zeros);
  score.noise_floor = nrmse_of_noise(problem, record);
  score.variance_before = before.variance(fold);
  score.variance_after = after.variance(fold);
  return score;
}

}  // namespace

Zeros zeros_of(const TestedHypothesis& named) {
  const Problem& problem = named.problem();
  Zeros zeros(problem.records());
  for (std::size_t i = 0; i < zeros.size(); ++i) {
    const MatrixXd prediction = named.prediction(i);
    const Drive& drive = problem.drive(i);
    if (prediction.size() > 0 && !problem.relation().has_free_offsets())
      zeros[i] = drive.compared_rows(drive.measured - prediction).colwise().mean();
  }
  return zeros;
}

double nrmse(const TestedHypothesis& tested, std::size_t record, const Zeros& zeros) {
  const MatrixXd prediction = tested.prediction(record);
  const Problem& problem = tested.problem();
  const Drive& drive = problem.drive(record);
  if (prediction.size() == 0) return std::nan("");
  MatrixXd error = drive.compared_rows(drive.measured - prediction);
  const bool has_zero = zeros[record].size() > 0;
  if (has_zero) error.rowwise() -= zeros[record];
  return relative_size(problem.relation(), energy_of(std::move(error), !has_zero),
                       energy_about_mean(drive, drive.measured));
}

double nrmse_of_noise(const Problem& problem, std::size_t record) {
  const Drive& drive = problem.drive(record);
  const auto& draws = problem.draws(record);
  ArrayXd noise = ArrayXd::Zero(drive.measured.cols());
  for (const auto& draw : draws)
    noise += energy_about_mean(drive, draw) / static_cast<double>(draws.size());
  return relative_size(problem.relation(), noise, energy_about_mean(drive, drive.measured));
}

std::vector<RecordScore> scores_of(const Problem& problem, const Selection& selection,
                                   bool is_proof) {
  const TestedHypothesis before{problem, selection.base}, after{problem, selection.named};
  const Zeros zeros = zeros_of(after);
  std::vector<RecordScore> scores;
  for (std::size_t i = 0; i < problem.records(); ++i) {
    scores.push_back(score_of(before, after, zeros, i));
    scores.back().use = is_proof                                ? "held_out"
                        : problem.record(i).use == Use::HeldOut ? "scored"
                                                                : "fit";
  }
  return scores;
}

Whiteness whiteness_of(const TestedHypothesis& named, std::size_t record) {
  const MatrixXd white = named.whitened(record);
  const ArrayXd weight = named.problem().drive(record).compared();
  VectorXd correlation = VectorXd::Zero(kLags);
  double portmanteau = 0;
  const double n = weight.sum();
  for (Index output = 0; output < white.cols(); ++output) {
    const VectorXd x = weight * (white.col(output).array() - white.col(output).sum() / n);
    const double square = std::max(x.squaredNorm(), 1e-300);
    double q = 0;
    for (Index lag = 1; lag <= kLags && lag < x.size(); ++lag) {
      const double r = x.tail(x.size() - lag).dot(x.head(x.size() - lag)) / square;
      correlation[lag - 1] += r / static_cast<double>(white.cols());
      q += n * (n + 2) * r * r / (n - static_cast<double>(lag));
    }
    portmanteau = std::max(portmanteau, q);
  }
  // The colour of the noise is an estimate, so three times the quantile of 20 degrees of freedom is
  // allowed.
  return {{correlation.begin(), correlation.end()},
          maths::kNormal95 / std::sqrt(n * static_cast<double>(white.cols())),
          portmanteau < kAllowance * kChiSquare99};
}

double scatter_of(const TestedHypothesis& tested, const Fold& fold) {
  const double variance = tested.variance(fold);
  if (!(variance > kWellAbove)) return 1;
  double neighbours = 0;
  for (const auto& share : fold.shares) {
    const Whiteness whiteness = whiteness_of(tested, share.record);
    neighbours += 1;
    for (const double r : whiteness.correlation) {
      if (r < whiteness.bound) break;
      neighbours += 2 * r;
    }
  }
  return variance * neighbours / static_cast<double>(fold.shares.size());
}

Proof proof_of(const Problem& problem, const Selection& selection, bool is_held_out) {
  Proof proof;
  proof.records = scores_of(problem, selection, is_held_out);
  proof.is_held_out = is_held_out;
  proof.is_white = true;
  const bool one_unit = have_one_unit(problem.relation());
  double all = 0;
  for (std::size_t i = 0; i < problem.records(); ++i) {
    proof.whiteness = whiteness_of(TestedHypothesis{problem, selection.named}, i);
    proof.is_white = proof.is_white && proof.whiteness.is_white;
    const Drive& drive = problem.drive(i);
    const double weight = one_unit ? energy_about_mean(drive, drive.measured).sum() : 1;
    const RecordScore& score = proof.records[i];
    all += weight;
    proof.before += weight * score.nrmse_before * score.nrmse_before;
    proof.after += weight * score.nrmse_after * score.nrmse_after;
    proof.floor += weight * score.noise_floor * score.noise_floor;
  }
  for (double* error : {&proof.before, &proof.after, &proof.floor})
    *error = std::sqrt(*error / all);
  return proof;
}

double Proof::explained() const {
  const double beyond = before * before - floor * floor;
  return beyond > 0 ? std::clamp((before * before - after * after) / beyond, 0.0, 1.0) : 0;
}

double Proof::variance() const {
  double most = 0;
  for (const RecordScore& score : records) most = std::max(most, score.variance_after);
  return most;
}

bool Proof::is_systematic() const {
  return !is_white && variance() > kWellAbove &&
         (times_noise() > kWellAbove || variance() > kFarAbove);
}

}  // namespace rths::diagnosis
