// SPDX-License-Identifier: Apache-2.0
#include "form_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include <rths/identification/constants.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/fourier.hpp>

namespace rths::diagnosis {
namespace {

// Whitened residual of a share of a fold, rows × outputs; zero where the share has no weight.
struct OutputRows {
  const ResidualNoise& noise;
  double time_step;
  ArrayXd weight;
  MatrixXd residual;

  OutputRows(const TestedHypothesis& tested, const Fold::Share& share, MatrixXd whitened)
      : noise{tested.problem().noise(share.record)},
        time_step{tested.problem().drive(share.record).time_step},
        residual{std::move(whitened)} {
    weight = share.weight.size() > 0 ? share.weight : ArrayXd::Ones(residual.rows());
    residual.array().colwise() *= weight;
  }
  [[nodiscard]] double duration() const { return static_cast<double>(residual.rows()) * time_step; }
  // Whitened cosine and sine in an output.
  [[nodiscard]] MatrixXd waves(Index output, double frequency) const {
    const Index n = residual.rows();
    const VectorXd phase = VectorXd::LinSpaced(n, 0, static_cast<double>(n - 1)) *
                           (2 * std::numbers::pi * frequency * time_step);
    MatrixXd waves(n, 2);
    waves << noise.whitened(VectorXd{phase.array().cos()}, output),
        noise.whitened(VectorXd{phase.array().sin()}, output);
    waves.array().colwise() *= weight;
    return waves;
  }
};

std::vector<OutputRows> rows_of(const TestedHypothesis& tested, const Fold& fold) {
  std::vector<OutputRows> all;
  for (const auto& share : fold.shares)
    all.emplace_back(tested, share, tested.whitened(share.record));
  return all;
}

// The same of the predictions.
std::vector<OutputRows> predicted_rows_of(const TestedHypothesis& tested, const Fold& fold) {
  std::vector<OutputRows> all;
  for (const auto& share : fold.shares) {
    MatrixXd predicted = tested.prediction(share.record);
    predicted.rowwise() -= predicted.colwise().mean().eval();
    all.emplace_back(tested, share, tested.problem().noise(share.record).whitened(predicted));
  }
  return all;
}

// Sum over records and outputs of `energy(waves, residual)`, each with its own sine.
template <class Energy>
double sum_over_outputs(const std::vector<OutputRows>& all, double frequency,
                        const Energy& energy) {
  double sum = 0;
  for (const auto& rows : all)
    for (Index output = 0; output < rows.residual.cols(); ++output)
      sum += energy(rows.waves(output, frequency), VectorXd{rows.residual.col(output)});
  return sum;
}

// Energy that sines of a frequency explain.
double explained(const std::vector<OutputRows>& all, double frequency) {
  return sum_over_outputs(all, frequency, [](const MatrixXd& waves, const VectorXd& w) {
    return w.squaredNorm() - (w - waves * maths::solve_least_squares(waves, w)).squaredNorm();
  });
}

// Energy that sines explain in the other half of the record to which they were fitted. A sine goes
// on with its phase; a resonance under random forces loses it.
double continued(const std::vector<OutputRows>& all, double frequency) {
  return sum_over_outputs(all, frequency, [](const MatrixXd& waves, const VectorXd& w) {
    const Index half = w.size() / 2, rest = w.size() - half;
    const MatrixXd early = waves.topRows(half), late = waves.bottomRows(rest);
    const VectorXd first = w.head(half), second = w.tail(rest);
    return w.squaredNorm() -
           (first - early * maths::solve_least_squares(late, second)).squaredNorm() -
           (second - late * maths::solve_least_squares(early, first)).squaredNorm();
  });
}

// Highest line of the summed periodograms.
double highest_line(const std::vector<OutputRows>& all) {
  Index longest = 0;
  for (const auto& rows : all) longest = std::max(longest, rows.residual.rows());
  const Index length = maths::fast_length(kZeroPadding * longest);
  VectorXd sum = VectorXd::Zero(length / 2);
  for (const auto& rows : all)
    for (Index output = 0; output < rows.residual.cols(); ++output) {
      VectorXd padded = VectorXd::Zero(length);
      padded.head(rows.residual.rows()) = rows.residual.col(output);
      sum += maths::spectrum(padded).head(length / 2).cwiseAbs2();
    }
  const double step = 1 / (static_cast<double>(length) * all[0].time_step);
  const auto first = std::min(
      static_cast<Index>(std::ceil(kLeastPeriods / (all[0].duration() * step))), length / 2 - 1);
  Index at = 0;
  sum.tail(sum.size() - first).maxCoeff(&at);
  return static_cast<double>(first + at) * step;
}

// The frequency near a line at which sines explain most.
double refined(const std::vector<OutputRows>& all, double line) {
  double at = line, best = explained(all, line);
  for (double step = 1 / (kZeroPadding * all[0].duration()); step * all[0].duration() > 1e-3;
       step /= 2)
    for (const double tried : {at - step, at + step})
      if (const double energy = explained(all, tried); energy > best) best = energy, at = tried;
  return at;
}

double residual_energy(const std::vector<OutputRows>& all) {
  double energy = 0;
  for (const auto& rows : all) energy += rows.residual.squaredNorm();
  return energy;
}

// Whether a frequency is a low multiple of that of a periodic test, whose residual is periodic too,
// whatever the missing effect.
bool is_of_test(const std::vector<OutputRows>& predicted, double frequency) {
  constexpr double kPeriodic = 0.5;  // of the energy of the prediction
  constexpr double kMostOrder = 9;
  const double test = refined(predicted, highest_line(predicted));
  const double order = std::round(frequency / test);
  return order >= 1 && order <= kMostOrder &&
         std::abs(frequency - order * test) * predicted[0].duration() < 1 &&
         continued(predicted, test) > kPeriodic * residual_energy(predicted);
}

}  // namespace

void find_periodic_force(const TestedHypothesis& tested, const Folds& folds,
                         std::vector<Description>& found) {
  if (!tested.problem().drive(0).has_time) return;
  const auto first = rows_of(tested, folds.first);
  const double frequency = refined(first, highest_line(first));
  if (is_of_test(predicted_rows_of(tested, folds.first), frequency)) return;
  const double share =
      continued(rows_of(tested, folds.second), frequency) / excess_on(tested, folds.second);
  // A force that acts at rest, too, is a part of the estimated noise.
  found.push_back({fmt::format("external periodic force at {:.2f} Hz", frequency),
                   std::min(1.0, share),
                   "",
                   {},
                   {},
                   {},
                   Description::Over::Time});
}

}  // namespace rths::diagnosis
