// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/excess.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "transform.hpp"

namespace rths::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Cells::Cells(const Seen& seen, const std::function<Energies(const MatrixXd&)>& energies)
    : energy_{energies(seen.residual)},
      expected_(energy_.size(), 0.0),
      scatter_(energy_.size(), 0.0) {
  const auto draws = static_cast<double>(seen.noise.size());
  for (const auto& noise : seen.noise) {
    const Energies drawn = energies(noise);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      expected_[i] += drawn[i] / draws;
      scatter_[i] += drawn[i] * drawn[i] / draws;
    }
  }
  for (std::size_t i = 0; i < size(); ++i)
    scatter_[i] = std::sqrt(std::max(0.0, scatter_[i] - expected_[i] * expected_[i]));
}

double Cells::signal_share(std::size_t cell) const {
  return std::max(0.0, beyond_noise(cell) / std::max(energy_[cell], 1e-300));
}

std::vector<double> Cells::shares() const {
  double total = 0;
  for (std::size_t i = 0; i < size(); ++i)
    if (beyond_noise(i) > 2 * scatter_[i]) total += beyond_noise(i);
  std::vector<double> shares;
  for (std::size_t i = 0; i < size(); ++i)
    shares.push_back(beyond_noise(i) / std::max(total, 1e-300));
  return shares;
}

// Small excesses are below the noise one by one but not in their sum, so every cell counts.
std::vector<bool> Cells::place() const {
  constexpr double kShare = 0.8;  // of the excess
  double total = 0;
  for (std::size_t i = 0; i < size(); ++i) total += beyond_noise(i);
  std::vector<std::size_t> order(size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return beyond_noise(a) > beyond_noise(b); });
  std::vector<bool> inside(size(), false);
  double held = 0;
  for (const std::size_t cell : order) {
    if (held >= kShare * total || beyond_noise(cell) <= 0) break;
    held += beyond_noise(cell);
    inside[cell] = true;
  }
  return inside;
}

std::function<Energies(const MatrixXd&)> by_row(
    std::size_t cells, const Drive& drive,
    const std::function<std::size_t(Index, Index)>& cell_of) {
  // Computed once for many signals.
  std::vector<std::size_t> cell;
  const Index outputs = drive.measured.cols();
  for (Index row = drive.first_row; row < drive.rows(); ++row)
    for (Index output = 0; output < outputs; ++output) cell.push_back(cell_of(row, output));
  return [cells, outputs, first = drive.first_row, cell = std::move(cell)](const MatrixXd& signal) {
    Energies energies(cells + 1, 0.0);
    std::size_t next = 0;
    for (Index row = first; row < signal.rows(); ++row)
      for (Index output = 0; output < outputs; ++output)
        energies[std::min(cell[next++], cells)] += signal(row, output) * signal(row, output);
    energies.pop_back();
    return energies;
  };
}

Bands::Bands(const std::vector<double>& edges, const Drive& drive)
    : rows_{drive.rows()}, length_{fast_length(2 * rows_)}, count_{edges.size() - 1} {
  for (Index k = 0; k < length_; ++k) {
    const double f = static_cast<double>(std::min(k, length_ - k)) /
                     (static_cast<double>(length_) * drive.time_step);
    const auto edge = std::upper_bound(edges.begin(), edges.end(), f);
    band_.push_back(static_cast<std::size_t>(edge - edges.begin()) - 1);
  }
}

Energies Bands::energies(const MatrixXd& signal) const {
  Energies result(count_ + 1, 0.0);
  for (Index output = 0; output < signal.cols(); ++output) {
    const Eigen::VectorXcd bins = transformed(signal.col(output));
    for (Index k = 0; k < length_; ++k)
      result[band(k)] += std::norm(bins[k]) / static_cast<double>(length_);
  }
  result.pop_back();
  return result;
}

MatrixXd Bands::weighed(const MatrixXd& signal, std::vector<double> weights) const {
  weights.push_back(0);
  MatrixXd result(signal.rows(), signal.cols());
  for (Index output = 0; output < signal.cols(); ++output) {
    Eigen::VectorXcd bins = transformed(signal.col(output));
    for (Index k = 0; k < length_; ++k) bins[k] *= weights[band(k)];
    VectorXd y;
    transformer().inv(y, bins);
    result.col(output) = y.head(rows_);
  }
  return result;
}

Eigen::VectorXcd Bands::transformed(const VectorXd& signal) const {
  VectorXd x = VectorXd::Zero(length_);
  x.head(rows_) = signal;
  Eigen::VectorXcd bins;
  transformer().fwd(bins, x);
  return bins;
}

namespace {

// Removes from signals their components along other signals, which are not excess.
class Projection {
 public:
  void add(MatrixXd signal) {
    remove_from(signal);
    const double size = signal.norm();
    if (size > 0) basis_.push_back(signal / size);
  }
  void remove_from(MatrixXd& signal) const {
    for (const auto& one : basis_) signal -= one * one.cwiseProduct(signal).sum();
  }

 private:
  std::vector<MatrixXd> basis_;  // orthonormal
};

// A short predictor from the autocovariance (Yule 1927, Walker 1931). It whitens the frequencies
// with most of the energy. Longer predictors amplify the others.
AutoRegression predictor(const std::vector<VectorXd>& signals, int order) {
  VectorXd covariance = VectorXd::Zero(order + 1);
  double count = 0;
  for (const auto& x : signals) {
    const Index n = x.size() - order;
    for (int lag = 0; lag <= order; ++lag)
      covariance[lag] += x.tail(n).dot(x.segment(order - lag, n));
    count += static_cast<double>(n);
  }
  covariance /= std::max(count, 1.0);
  AutoRegression model{VectorXd::Zero(order), 1};
  double variance = covariance[0];
  for (int m = 0; m < order && variance > 0; ++m) {
    double reflection = covariance[m + 1];
    for (int k = 0; k < m; ++k) reflection -= model.coefficients[k] * covariance[m - k];
    reflection /= variance;
    const VectorXd before = model.coefficients;
    model.coefficients[m] = reflection;
    for (int k = 0; k < m; ++k) model.coefficients[k] -= reflection * before[m - 1 - k];
    variance *= 1 - reflection * reflection;
  }
  if (variance > 0) model.deviation = std::sqrt(variance);
  return model;
}

// Divides by the size of the noise at each time, then whitens by its mean colour.
class Whitening {
 public:
  explicit Whitening(const Problem& problem)
      : first_row_{problem.drive(0).first_row}, deviation_{problem.noise(0).deviation()} {
    if (!problem.has_colour()) return;
    // The noise of differences of a displacement rises too steeply for a few lags.
    const bool is_steep = problem.relation().outputs()[0].first.starts_with("acceleration.");
    order_ = is_steep ? 12 : 4;
    for (Index output = 0; output < deviation_.cols(); ++output) {
      std::vector<VectorXd> scaled;
      for (const auto& draw : problem.draws(0))
        scaled.emplace_back(draw.col(output).cwiseQuotient(deviation_.col(output)));
      colours_.push_back(predictor(scaled, order_));
    }
  }
  [[nodiscard]] MatrixXd operator()(const MatrixXd& residual) const {
    MatrixXd white = residual.cwiseQuotient(deviation_);
    for (std::size_t i = 0; i < colours_.size(); ++i) {
      const auto output = static_cast<Index>(i);
      white.col(output) = colours_[i].whitened(white.col(output));
    }
    // Rows before the first one are not known.
    white.topRows(std::min(first_row_ + order_, white.rows())).setZero();
    return white;
  }

 private:
  Index first_row_;
  int order_ = 0;
  MatrixXd deviation_;
  std::vector<AutoRegression> colours_;  // of every output; none if not known
};

// Noise of unknown colour counts as white, of the known size.
std::vector<MatrixXd> white_noise(const Drive& drive, std::size_t draws) {
  std::mt19937_64 random{1};
  std::normal_distribution<double> normal;
  std::vector<MatrixXd> noise;
  for (std::size_t i = 0; i < draws; ++i) {
    noise.push_back(
        MatrixXd::NullaryExpr(drive.rows(), drive.measured.cols(), [&] { return normal(random); }));
    noise.back().topRows(drive.first_row).setZero();
  }
  return noise;
}

}  // namespace

Seen seen_at(const Problem& problem, const Hypothesis& hypothesis) {
  const Drive& drive = problem.drive(0);
  std::vector<Index> all;  // free parameters, without tolerances
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i)
    if (!hypothesis.free[i].is_tolerance) all.push_back(static_cast<Index>(i));
  MatrixXd prediction;
  std::vector<MatrixXd> derivatives;
  if (!problem.relation()
           .simulator(hypothesis, drive)
           ->run(hypothesis.values, all, prediction, derivatives))
    throw Error{problem.record(0).name + ": the model has no prediction"};
  const Whitening white{problem};
  Projection projection;
  if (problem.relation().has_free_offsets())
    for (Index output = 0; output < prediction.cols(); ++output) {
      MatrixXd constant = MatrixXd::Zero(prediction.rows(), prediction.cols());
      constant.col(output).setOnes();
      projection.add(white(constant));
    }
  for (const auto& derivative : derivatives) projection.add(white(derivative));
  Seen seen{white(drive.measured - prediction), {}};
  if (problem.has_colour())
    for (const auto& draw : problem.draws(0)) seen.noise.push_back(white(draw));
  else
    seen.noise = white_noise(drive, problem.draws(0).size());
  projection.remove_from(seen.residual);
  for (auto& noise : seen.noise) projection.remove_from(noise);
  return seen;
}

}  // namespace rths::diagnosis
