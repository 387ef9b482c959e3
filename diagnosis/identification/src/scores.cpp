// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/scores.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include <rths/core/error.hpp>
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
    return Supposition{problem, hypothesis}.fit(fold, iterations);
  } catch (const Error&) {
    return std::nullopt;
  }
}

Hypothesis fitted(const Problem& problem, const Hypothesis& hypothesis, const Fold& fold,
                  int iterations) {
  Hypothesis result = Supposition{problem, hypothesis}.hypothesis();
  // Without a prediction from which a fit could begin, the values stay.
  if (const auto fit = fit_if_possible(problem, hypothesis, fold, iterations))
    result.values = fit->parameters;
  return result;
}

std::vector<double> scores(const Problem& problem, const Hypothesis& hypothesis, const Fold& fold) {
  const Supposition supposition{problem, hypothesis};
  auto sums = supposition.blocks(fold);
  // A free run is driven by exact inputs.
  if (problem.relation().runs_freely() || sums.empty()) return sums;
  return minus(sums, supposition.noise_blocks(fold));
}

namespace {

// Removes from each column of a difference what a shift of the signal in time explains.
void take_out_shift(const Eigen::MatrixXd& signal, double time_step, Eigen::MatrixXd& difference) {
  for (Eigen::Index i = 0; i < signal.cols(); ++i) {
    const Eigen::VectorXd rate = rate_of(signal.col(i), time_step);
    const double square = rate.squaredNorm();
    if (square > 0) difference.col(i) -= rate * (rate.dot(difference.col(i)) / square);
  }
}

}  // namespace

double change_of(const Problem& problem, const Hypothesis& before, const Hypothesis& after,
                 const Fold& fold, bool without_shift) {
  const Supposition a{problem, before}, b{problem, after};
  double change = 0, size = 0;
  for (const auto& share : fold.shares) {
    const Eigen::MatrixXd with = b.prediction(share.record), bare = a.prediction(share.record);
    if (with.size() == 0 || bare.size() == 0) continue;
    Eigen::MatrixXd difference = with - bare;
    Eigen::MatrixXd measured = problem.drive(share.record).measured;
    if (problem.relation().has_free_offsets())
      difference.rowwise() -= difference.colwise().mean().eval();
    measured.rowwise() -= measured.colwise().mean().eval();
    if (without_shift) take_out_shift(bare, problem.drive(share.record).time_step, difference);
    change += difference.squaredNorm();
    size += measured.squaredNorm();
  }
  return std::sqrt(change / std::max(size, 1e-300));
}

std::vector<double> resampled_sums(const std::vector<double>& blocks, std::uint64_t seed) {
  constexpr int kResamples = 400;
  constexpr std::size_t kNeighbours = 3;
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

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto index = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index),
                   values.end());
  return values[index];
}

}  // namespace rths::diagnosis
