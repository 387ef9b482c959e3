// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/scores.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include <rths/core/error.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/signal.hpp>

namespace rths::diagnosis {

std::vector<double> minus(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference(std::min(a.size(), b.size()));
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = a[i] - b[i];
  return difference;
}

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

std::optional<Fit> fit_if_possible(const Problem& problem, const Hypothesis& hypothesis,
                                   const Fold& fold, int iterations) {
  try {
    return TestedHypothesis{problem, hypothesis}.fit(fold, iterations);
  } catch (const Error&) {
    return std::nullopt;
  }
}

Hypothesis fitted(const Problem& problem, const Hypothesis& hypothesis, const Fold& fold,
                  int iterations) {
  Hypothesis result = TestedHypothesis{problem, hypothesis}.hypothesis();
  // Without a prediction from which a fit could begin, the values stay.
  if (const auto fit = fit_if_possible(problem, hypothesis, fold, iterations))
    result.values = fit->parameters;
  return result;
}

std::vector<double> scores(const Problem& problem, const Hypothesis& hypothesis, const Fold& fold) {
  const TestedHypothesis tested{problem, hypothesis};
  auto sums = tested.blocks(fold);
  // A free run is driven by exact inputs.
  if (problem.relation().runs_freely() || sums.empty()) return sums;
  return minus(sums, tested.noise_blocks(fold));
}

bool have_one_unit(const Relation& relation) {
  const auto& outputs = relation.outputs();
  return std::all_of(outputs.begin(), outputs.end(),
                     [&](const auto& output) { return output.second == outputs[0].second; });
}

ArrayXd energy_of(MatrixXd signal, bool about_mean) {
  if (about_mean) signal.rowwise() -= signal.colwise().mean().eval();
  return signal.colwise().squaredNorm().transpose();
}

double relative_size(const Relation& relation, const ArrayXd& energy, const ArrayXd& of) {
  return std::sqrt(have_one_unit(relation) ? energy.sum() / of.sum() : (energy / of).mean());
}

namespace {

// Removes from each column of a difference what a shift of the signal in time explains.
void take_out_shift(const MatrixXd& signal, double time_step, MatrixXd& difference) {
  for (Index i = 0; i < signal.cols(); ++i) {
    const VectorXd rate = rate_of(signal.col(i), time_step);
    const double square = rate.squaredNorm();
    if (square > 0) difference.col(i) -= rate * (rate.dot(difference.col(i)) / square);
  }
}

}  // namespace

double change_of(const Problem& problem, const Hypothesis& before, const Hypothesis& after,
                 const Fold& fold, bool without_shift) {
  const TestedHypothesis a{problem, before}, b{problem, after};
  const auto outputs = static_cast<Index>(problem.relation().outputs().size());
  ArrayXd change = ArrayXd::Zero(outputs), size = ArrayXd::Constant(outputs, 1e-300);
  for (const auto& share : fold.shares) {
    const MatrixXd with = b.prediction(share.record), bare = a.prediction(share.record);
    if (with.size() == 0 || bare.size() == 0) continue;
    const Drive& drive = problem.drive(share.record);
    MatrixXd difference = with - bare;
    if (without_shift) take_out_shift(bare, drive.time_step, difference);
    change += energy_of(drive.compared_rows(difference), problem.relation().has_free_offsets());
    size += energy_of(drive.compared_rows(drive.measured), true);
  }
  return relative_size(problem.relation(), change, size);
}

std::vector<double> resampled_sums(const std::vector<double>& blocks, std::uint64_t seed) {
  std::vector<double> sums;
  if (blocks.size() < kNeighbours) return sums;
  std::mt19937_64 random{seed};
  for (int k = 0; k < kResamples; ++k) {
    double total = 0;
    std::size_t taken = 0;
    while (taken < blocks.size()) {
      const std::size_t first = random() % (blocks.size() - kNeighbours + 1);
      for (std::size_t i = 0; i < kNeighbours && taken < blocks.size(); ++i, ++taken)
        total += blocks[first + i];
    }
    sums.push_back(total);
  }
  return sums;
}

}  // namespace rths::diagnosis
