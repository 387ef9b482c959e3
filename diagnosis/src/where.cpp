// SPDX-License-Identifier: Apache-2.0
#include "where.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <unsupported/Eigen/FFT>

#include "fast_length.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kCellTime = 0.256;  // [s]
constexpr int kStateCells = 9;       // along displacement and along velocity
constexpr double kShare = 0.8;       // of the excess that a place must hold

// A residual in units of its noise, and what of it the noise has.
struct Seen {
  MatrixXd white;
  double variance = 1;  // of its noise
  double fourth = 1;    // mean square of the noise's spectrum: how its sums scatter
};

// Energy and what noise has of it, cell by cell.
struct Cells {
  std::vector<double> energy, expected;
  double scatter = 1;  // variance of the noise's sum over what it is of white noise, once expected

  explicit Cells(std::size_t count) : energy(count, 0.0), expected(count, 0.0) {}
  Cells(std::size_t count, const Seen& seen) : Cells{count} {
    scatter = seen.fourth / seen.variance;
  }
  void add(std::size_t cell, double square, double noise = 1) {
    energy[cell] += square;
    expected[cell] += noise;
  }
  // What is beyond the noise, and beyond its scatter.
  [[nodiscard]] std::vector<double> excess() const {
    std::vector<double> result(energy.size(), 0.0);
    for (std::size_t i = 0; i < energy.size(); ++i) {
      const double beyond = energy[i] - expected[i];
      if (beyond > 2 * std::sqrt(2 * scatter * expected[i])) result[i] = beyond;
    }
    return result;
  }
  [[nodiscard]] std::vector<double> shares() const {
    double total = 0;
    for (const double e : excess()) total += e;
    std::vector<double> result;
    for (std::size_t i = 0; i < energy.size(); ++i)
      result.push_back((energy[i] - expected[i]) / std::max(total, 1e-300));
    return result;
  }
  // The smallest set of cells that holds most of the excess. Where cells are many, small excesses
  // are lost in the noise one by one, but not all of them together.
  [[nodiscard]] std::vector<bool> place(bool has_many) const {
    std::vector<double> beyond = excess();
    if (has_many)
      for (std::size_t i = 0; i < energy.size(); ++i) beyond[i] = energy[i] - expected[i];
    const double total = std::accumulate(beyond.begin(), beyond.end(), 0.0);
    std::vector<std::size_t> order(beyond.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return beyond[a] > beyond[b]; });
    std::vector<bool> inside(beyond.size(), false);
    double held = 0;
    for (const std::size_t cell : order) {
      if (held >= kShare * total || beyond[cell] <= 0) break;
      held += beyond[cell];
      inside[cell] = true;
    }
    return inside;
  }
};

std::vector<std::pair<double, double>> joined(const std::vector<bool>& inside,
                                              const std::vector<double>& edges) {
  std::vector<std::pair<double, double>> spans;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (!inside[i]) continue;
    if (i > 0 && inside[i - 1])
      spans.back().second = edges[i + 1];
    else
      spans.emplace_back(edges[i], edges[i + 1]);
  }
  return spans;
}

std::vector<double> third_octaves(double highest) {
  std::vector<double> edges{0};
  for (int k = 0;; ++k) {
    const double edge = std::pow(2.0, -2.5 + k / 3.0);
    edges.push_back(edge);
    if (edge >= highest) return edges;
  }
}

std::size_t cell_of(double value, double range) {
  const double cell = std::floor((value / range + 1) / 2 * kStateCells);
  return static_cast<std::size_t>(std::clamp(cell, 0.0, double{kStateCells - 1}));
}

Profile profile(const std::string& name, const std::string& unit, std::vector<double> edges,
                const Cells& cells) {
  return {name, unit, std::move(edges), cells.shares()};
}

void map_time(const Seen& seen, const Drive& drive, Where& where) {
  const MatrixXd& white = seen.white;
  const auto size = std::max<Index>(1, static_cast<Index>(std::round(kCellTime / drive.time_step)));
  const Index count = white.rows() / size;
  Cells cells{static_cast<std::size_t>(count), seen};
  for (Index row = drive.first_row; row < count * size; ++row)
    for (Index output = 0; output < white.cols(); ++output)
      cells.add(static_cast<std::size_t>(row / size), white(row, output) * white(row, output),
                seen.variance);
  std::vector<double> edges;
  for (Index i = 0; i <= count; ++i)
    edges.push_back(drive.start + static_cast<double>(i * size) * drive.time_step);
  where.intervals = joined(cells.place(true), edges);
  where.profiles.push_back(profile("time", "s", edges, cells));
}

// The residual, each third octave weighed by the part of it that is not noise (Wiener 1949): what
// remains of the noise hides less of the rest.
Seen weighed(const MatrixXd& white, const std::vector<double>& edges, const Cells& cells,
             double time_step) {
  Seen seen{MatrixXd(white.rows(), white.cols()), 0, 0};
  Eigen::FFT<double> transform;
  const Index length = fast_length(2 * white.rows());
  for (Index output = 0; output < white.cols(); ++output) {
    VectorXd x = VectorXd::Zero(length), y;
    x.head(white.rows()) = white.col(output);
    Eigen::VectorXcd bins;
    transform.fwd(bins, x);
    double square = 0, fourth = 0;
    for (Index k = 0; k < length; ++k) {
      const Index side = std::min(k, length - k);
      const double f = static_cast<double>(side) / (static_cast<double>(length) * time_step);
      const auto edge = std::upper_bound(edges.begin(), edges.end(), f);
      double weight = 0;
      if (edge != edges.end()) {
        const auto cell = static_cast<std::size_t>(edge - edges.begin()) - 1;
        if (cells.energy[cell] > 0)
          weight = std::max(0.0, 1 - cells.expected[cell] / cells.energy[cell]);
      }
      bins[k] *= weight;
      square += weight * weight / static_cast<double>(length);
      fourth += weight * weight * weight * weight / static_cast<double>(length);
    }
    transform.inv(y, bins);
    seen.white.col(output) = y.head(white.rows());
    seen.variance = square;
    seen.fourth = fourth;
  }
  // Nothing stands out: there is nothing to weigh.
  return seen.variance > 0 ? seen : Seen{white};
}

Cells map_frequency(const MatrixXd& white, const Drive& drive, const std::vector<double>& edges,
                    Where& where) {
  Cells cells{edges.size() - 1};
  Eigen::FFT<double> transform;
  const Index length = fast_length(2 * white.rows());
  for (Index output = 0; output < white.cols(); ++output) {
    VectorXd x = VectorXd::Zero(length);
    x.head(white.rows()) = white.col(output);
    Eigen::VectorXcd bins;
    transform.fwd(bins, x);
    for (Index k = 0; k <= length / 2; ++k) {
      const double f = static_cast<double>(k) / (static_cast<double>(length) * drive.time_step);
      const auto edge = std::upper_bound(edges.begin(), edges.end(), f);
      if (edge == edges.end()) continue;
      const auto cell = static_cast<std::size_t>(edge - edges.begin()) - 1;
      // Padding halves what each bin stands for.
      cells.energy[cell] += std::norm(bins[k]) / static_cast<double>(white.rows()) / 2;
      cells.expected[cell] += 0.5;
    }
  }
  where.bands = joined(cells.place(false), edges);
  where.profiles.push_back(profile("frequency", "Hz", edges, cells));
  return cells;
}

double round_up(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(std::max(value, 1e-300))));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value <= step * decade) return step * decade;
  return 10 * decade;
}

void map_states(const Seen& seen, const Drive& drive, const MapRange& range, Where& where) {
  const MatrixXd& white = seen.white;
  if (drive.displacement.size() == 0) return;
  const double u = range.displacement.value_or(round_up(drive.displacement.cwiseAbs().maxCoeff()));
  const double v = range.velocity.value_or(round_up(drive.velocity.cwiseAbs().maxCoeff()));
  Cells cells{kStateCells * kStateCells, seen};
  for (Index row = drive.first_row; row < white.rows(); ++row)
    for (Index output = 0; output < white.cols(); ++output) {
      const std::size_t cell = cell_of(drive.displacement(row, output), u) * kStateCells +
                               cell_of(drive.velocity(row, output), v);
      cells.add(cell, white(row, output) * white(row, output), seen.variance);
    }
  const auto inside = cells.place(true);
  const auto shares = cells.shares();
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (cells.expected[i] == 0) continue;
    const auto edge = [](double reach, std::size_t k) {
      return reach * (2 * static_cast<double>(k) / kStateCells - 1);
    };
    const std::size_t a = i / kStateCells, b = i % kStateCells;
    where.state_map.push_back(
        {{edge(u, a), edge(u, a + 1)}, {edge(v, b), edge(v, b + 1)}, shares[i]});
    if (inside[i]) where.states.push_back(where.state_map.back());
  }
}

void map_other_states(const Seen& seen, const Drive& drive, Where& where) {
  const MatrixXd& white = seen.white;
  for (const auto& [name, values] : drive.states) {
    const double low = values.minCoeff(), high = values.maxCoeff();
    if (!(high > low)) continue;
    constexpr std::size_t kCells = 9;
    Cells cells{kCells, seen};
    std::vector<double> edges;
    for (std::size_t i = 0; i <= kCells; ++i)
      edges.push_back(low + (high - low) * static_cast<double>(i) / kCells);
    for (Index row = drive.first_row; row < white.rows(); ++row)
      for (Index output = 0; output < white.cols(); ++output)
        cells.add(std::min(kCells - 1,
                           static_cast<std::size_t>((values[row] - low) / (high - low) * kCells)),
                  white(row, output) * white(row, output), seen.variance);
    const auto bracket = name.find(" [");
    where.profiles.push_back(profile(name.substr(0, bracket),
                                     name.substr(bracket + 2, name.size() - bracket - 3), edges,
                                     cells));
  }
}

}  // namespace

Where where_of(const Supposition& supposition, std::size_t record, const MapRange& range) {
  const Problem& problem = supposition.problem();
  const Drive& drive = problem.drive(record);
  const MatrixXd white = supposition.whitened(record);
  Where where;
  where.part = problem.relation().part();
  where.record = problem.record(record).name;
  const auto& outputs = problem.relation().outputs();
  // All of the outputs, unless one of them has nearly all of the excess.
  where.channel = outputs[0].first.substr(0, outputs[0].first.find('.'));
  for (Index output = 0; output < white.cols(); ++output) {
    const double own = white.col(output).squaredNorm() - static_cast<double>(white.rows());
    const double all = white.squaredNorm() - static_cast<double>(white.size());
    constexpr double kNearlyAll = 0.9;
    if (white.cols() == 1 || (all > 0 && own > kNearlyAll * all))
      where.channel = outputs[static_cast<std::size_t>(output)].first;
  }
  const std::vector<double> edges = third_octaves(std::min(26.0, 0.45 / drive.time_step));
  MatrixXd alike = drive.measured - supposition.prediction(record);
  if (problem.relation().has_free_offsets()) alike.rowwise() -= alike.colwise().mean().eval();
  alike = problem.noise(record).whitened_alike(alike);
  const Cells bands = map_frequency(alike, drive, edges, where);
  const Seen seen = weighed(alike, edges, bands, drive.time_step);
  map_time(seen, drive, where);
  map_states(seen, drive, range, where);
  map_other_states(seen, drive, where);
  return where;
}

MatrixXd excess_of(const Supposition& supposition, std::size_t record) {
  const MatrixXd white = supposition.whitened(record);
  const Drive& drive = supposition.problem().drive(record);
  const auto half =
      std::max<Index>(1, static_cast<Index>(std::round(kCellTime / drive.time_step / 2)));
  MatrixXd excess(white.rows(), white.cols());
  for (Index output = 0; output < white.cols(); ++output) {
    const VectorXd squares = white.col(output).cwiseAbs2();
    double sum = squares.head(std::min(half, squares.size())).sum();
    for (Index i = 0; i < squares.size(); ++i) {
      if (i + half < squares.size()) sum += squares[i + half];
      if (i - half - 1 >= 0) sum -= squares[i - half - 1];
      const Index count = std::min(squares.size() - 1, i + half) - std::max<Index>(0, i - half) + 1;
      excess(i, output) = std::max(0.0, sum / static_cast<double>(count) - 1);
    }
  }
  const double total = excess.sum();
  if (total > 0) excess /= total;
  return excess;
}

}  // namespace rths::diagnosis
