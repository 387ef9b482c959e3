// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/excess.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <random>

#include <rths/identification/constants.hpp>
#include <rths/maths/fourier.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::diagnosis {

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
  double total = 0;
  for (std::size_t i = 0; i < size(); ++i) total += beyond_noise(i);
  std::vector<std::size_t> order(size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return beyond_noise(a) > beyond_noise(b); });
  std::vector<bool> inside(size(), false);
  double held = 0;
  for (const std::size_t cell : order) {
    if (held >= kPlaceShare * total || beyond_noise(cell) <= 0) break;
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
    : rows_{drive.rows()}, length_{maths::fast_length(2 * rows_)}, count_{edges.size() - 1} {
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
    const VectorXcd bins = transformed(signal.col(output));
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
    VectorXcd bins = transformed(signal.col(output));
    for (Index k = 0; k < length_; ++k) bins[k] *= weights[band(k)];
    result.col(output) = maths::signal_of(bins).head(rows_);
  }
  return result;
}

VectorXcd Bands::transformed(const VectorXd& signal) const {
  VectorXd x = VectorXd::Zero(length_);
  x.head(rows_) = signal;
  return maths::spectrum(x);
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

// Mean of each value and its neighbours within half a width, periodic.
VectorXd neighbours_mean(const VectorXd& x, Index half) {
  const Index n = x.size();
  VectorXd y(n);
  double sum = 0;
  for (Index i = -half; i <= half; ++i) sum += x[(i + n) % n];
  for (Index i = 0; i < n; ++i) {
    y[i] = sum / static_cast<double>(2 * half + 1);
    sum += x[(i + half + 1) % n] - x[(i - half + n) % n];
  }
  return y;
}

// Divides by the size of the noise at each time, then by its mean amplitude at each frequency. That
// shifts nothing in time.
class Whitening {
 public:
  explicit Whitening(const Problem& problem)
      : compared_{problem.drive(0).compared()},
        deviation_{problem.noise(0).deviation()},
        length_{maths::fast_length(deviation_.rows())} {
    if (!problem.has_colour()) return;
    const double rows = compared_.sum();
    const double draws = static_cast<double>(problem.draws(0).size());
    for (Index output = 0; output < deviation_.cols(); ++output) {
      VectorXd density = VectorXd::Zero(length_);
      for (const auto& draw : problem.draws(0))
        density += transformed(draw.col(output), output).cwiseAbs2() / (rows * draws);
      density = neighbours_mean(density, std::max<Index>(1, length_ / kAmplitudeSmoothing));
      // Where the noise has hardly any energy, its colour is not known.
      const double least = kLeastAmplitude * kLeastAmplitude *
                           maths::median(std::vector<double>(density.begin(), density.end()));
      if (least > 0)
        amplitudes_.emplace_back(density.cwiseMax(least).cwiseSqrt());
      else
        amplitudes_.emplace_back(VectorXd::Ones(length_));
    }
  }
  [[nodiscard]] MatrixXd operator()(const MatrixXd& residual) const {
    MatrixXd white = residual.cwiseQuotient(deviation_);
    for (std::size_t i = 0; i < amplitudes_.size(); ++i) {
      const auto output = static_cast<Index>(i);
      white.col(output) =
          maths::signal_of(transformed(residual.col(output), output)
                               .cwiseQuotient(amplitudes_[i].cast<std::complex<double>>()))
              .head(white.rows());
    }
    white.array().colwise() *= compared_;
    return white;
  }

 private:
  [[nodiscard]] VectorXcd transformed(const VectorXd& signal, Index output) const {
    VectorXd scaled = VectorXd::Zero(length_);
    scaled.head(signal.size()) = compared_ * signal.cwiseQuotient(deviation_.col(output)).array();
    return maths::spectrum(scaled);
  }

  ArrayXd compared_;
  MatrixXd deviation_;
  Index length_;                      // of transforms
  std::vector<VectorXd> amplitudes_;  // of every output, by frequency; none if not known
};

// Noise of unknown colour counts as white, of the known size.
std::vector<MatrixXd> white_noise(const Drive& drive, std::size_t draws) {
  std::mt19937_64 random{1};
  std::normal_distribution<double> normal;
  std::vector<MatrixXd> noise;
  for (std::size_t i = 0; i < draws; ++i) {
    noise.push_back(
        MatrixXd::NullaryExpr(drive.rows(), drive.measured.cols(), [&] { return normal(random); }));
    noise.back().array().colwise() *= drive.compared();
  }
  return noise;
}

// @throws Error if there is no prediction
MatrixXd predicted(const Problem& problem, const Hypothesis& hypothesis,
                   const std::vector<Index>& by, std::vector<MatrixXd>& derivatives) {
  MatrixXd prediction;
  if (!problem.relation()
           .simulator(hypothesis, problem.drive(0))
           ->run(hypothesis.values, by, prediction, derivatives))
    throw Error{problem.record(0).name + ": the model has no prediction"};
  return prediction;
}

// A prediction, and the part of a signal that neither fitted parameters nor free offsets explain.
class Unexplained {
 public:
  Unexplained(const Problem& problem, const Hypothesis& hypothesis) : white_{problem} {
    std::vector<Index> all;  // free parameters, without tolerances
    for (std::size_t i = 0; i < hypothesis.free.size(); ++i)
      if (!hypothesis.free[i].is_tolerance) all.push_back(static_cast<Index>(i));
    std::vector<MatrixXd> derivatives;
    prediction_ = predicted(problem, hypothesis, all, derivatives);
    if (problem.relation().has_free_offsets())
      for (Index output = 0; output < prediction_.cols(); ++output) {
        MatrixXd constant = MatrixXd::Zero(prediction_.rows(), prediction_.cols());
        constant.col(output).setOnes();
        projection_.add(white_(constant));
      }
    for (const auto& derivative : derivatives) projection_.add(white_(derivative));
  }
  [[nodiscard]] MatrixXd of(const MatrixXd& signal) const { return of_noise(signal - prediction_); }
  [[nodiscard]] MatrixXd of_noise(const MatrixXd& draw) const { return of_white(white_(draw)); }
  [[nodiscard]] MatrixXd of_white(MatrixXd white) const {
    projection_.remove_from(white);
    return white;
  }

 private:
  Whitening white_;
  MatrixXd prediction_;
  Projection projection_;
};

}  // namespace

Seen seen_at(const Problem& problem, const Hypothesis& hypothesis) {
  const Drive& drive = problem.drive(0);
  const Unexplained unexplained{problem, hypothesis};
  Seen seen{unexplained.of(drive.measured), {}};
  if (problem.has_colour())
    for (const auto& draw : problem.draws(0)) seen.noise.push_back(unexplained.of_noise(draw));
  else
    for (auto& draw : white_noise(drive, problem.draws(0).size()))
      seen.noise.push_back(unexplained.of_white(std::move(draw)));
  return seen;
}

Seen seen_at(const Problem& problem, const Hypothesis& hypothesis, const Hypothesis& complete) {
  std::vector<MatrixXd> none;
  return {Unexplained{problem, hypothesis}.of(predicted(problem, complete, {}, none)), {}};
}

}  // namespace rths::diagnosis
