// SPDX-License-Identifier: Apache-2.0
#include "where.hpp"

#include <algorithm>
#include <cmath>

#include <rths/identification/excess.hpp>
#include <rths/identification/scores.hpp>

namespace rths::diagnosis {
namespace {

constexpr double kCellTime = 0.256;  // [s]; of a cell in noise, at least
constexpr double kCellRows = 8;      // the same without time
constexpr double kTimeCells = 100;   // of a record
constexpr double kHighest = 0.45;    // of the sampling rate: highest third octave
constexpr int kStateCells = 9;       // along displacement and along velocity
constexpr std::size_t kDraws = 24;   // of the noise
constexpr int kFit = 5;              // iterations

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
  const double duration = static_cast<double>(drive.rows()) * drive.time_step;
  // Noise needs longer cells than a prediction, which has none.
  const double in_noise = drive.has_time ? kCellTime : kCellRows;
  const double cell =
      std::max(duration / kTimeCells, seen.noise.empty() ? drive.time_step : in_noise);
  const double rows = cell / drive.time_step;
  const auto count = static_cast<std::size_t>(std::floor(duration / cell + 1e-9));
  const Cells cells{seen, by_row(count, drive, [&](Index row, Index) {
                      return static_cast<std::size_t>(static_cast<double>(row) / rows);
                    })};
  std::vector<double> edges;
  for (std::size_t i = 0; i <= count; ++i)
    edges.push_back(drive.start + static_cast<double>(i) * cell);
  where.intervals = joined(cells.place(), edges);
  where.profiles.push_back(drive.has_time ? profile("time", "s", edges, cells)
                                          : profile("row", "-", edges, cells));
}

// Maps frequency, and weights each third octave by its fraction that is not noise (Wiener 1949), so
// that the noise hides less of the mismatch. @returns the weighted residual
Seen map_frequency(const Seen& seen, const Drive& drive, Where& where) {
  const std::vector<double> edges = third_octaves(kHighest / drive.time_step);
  const Bands bands{edges, drive};
  const Cells cells{seen, [&](const MatrixXd& signal) { return bands.energies(signal); }};
  where.bands = joined(cells.place(), edges);
  where.profiles.push_back(profile("frequency", "Hz", edges, cells));
  std::vector<double> weights;
  for (std::size_t i = 0; i < cells.size(); ++i) weights.push_back(cells.signal_share(i));
  // No band exceeds the noise: no weights.
  if (std::all_of(weights.begin(), weights.end(), [](double w) { return w == 0; })) return seen;
  Seen rest;
  rest.residual = bands.weighed(seen.residual, weights);
  for (const auto& noise : seen.noise) rest.noise.push_back(bands.weighed(noise, weights));
  return rest;
}

double round_up(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(std::max(value, 1e-300))));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value <= step * decade) return step * decade;
  return 10 * decade;
}

void map_states(const Seen& seen, const Drive& drive, const MapRange& range, Where& where) {
  if (drive.displacement.size() == 0) return;
  const double u = range.displacement.value_or(round_up(drive.displacement.cwiseAbs().maxCoeff()));
  const double v = range.velocity.value_or(round_up(drive.velocity.cwiseAbs().maxCoeff()));
  const auto cell = [&](Index row, Index output) {
    return cell_of(drive.displacement(row, output), u) * kStateCells +
           cell_of(drive.velocity(row, output), v);
  };
  const Cells cells{seen, by_row(std::size_t{kStateCells} * kStateCells, drive, cell)};
  const auto inside = cells.place();
  const auto shares = cells.shares();
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (cells.is_empty(i)) continue;
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
  for (const auto& state : drive.states) {
    const auto& [name, values] = state;
    const double low = values.minCoeff(), high = values.maxCoeff();
    if (!(high > low)) continue;
    constexpr std::size_t kCells = 9;
    const auto cell = [low, high, at = &values](Index row, Index) {
      return std::min(kCells - 1,
                      static_cast<std::size_t>(((*at)[row] - low) / (high - low) * kCells));
    };
    const Cells cells{seen, by_row(kCells, drive, cell)};
    std::vector<double> edges;
    for (std::size_t i = 0; i <= kCells; ++i)
      edges.push_back(low + (high - low) * static_cast<double>(i) / kCells);
    const auto bracket = name.find(" [");
    where.profiles.push_back(profile(name.substr(0, bracket),
                                     name.substr(bracket + 2, name.size() - bracket - 3), edges,
                                     cells));
  }
}

// The output that has nearly all of the excess, or the family of all outputs.
std::string channel_of(const Problem& problem, const Seen& seen) {
  constexpr double kNearlyAll = 0.9;
  const auto& outputs = problem.relation().outputs();
  const auto by_output = [](const MatrixXd& signal) {
    Energies energies;
    for (Index output = 0; output < signal.cols(); ++output)
      energies.push_back(signal.col(output).squaredNorm());
    return energies;
  };
  const Cells cells{seen, by_output};
  double all = 0;
  for (std::size_t i = 0; i < outputs.size(); ++i) all += cells.beyond_noise(i);
  for (std::size_t i = 0; i < outputs.size(); ++i)
    if (outputs.size() == 1 || (all > 0 && cells.beyond_noise(i) > kNearlyAll * all))
      return outputs[i].first;
  return family_of(outputs[0].first);
}

}  // namespace

Where where_of(const RelationFindings& found, const MapRange& range) {
  // The stated model without named terms, fitted to this record alone. A wrong hysteresis rule
  // would hide other effects, so the right one is included.
  const Selection& selection = found.selection;
  const bool is_all = selection.has_only_rules() && !found.is_unknown();
  const Hypothesis& unnamed = is_all ? selection.base : selection.ruled;
  Problem problem{*found.relation, {&found.first}, *found.noise, found.seed, kDraws};
  problem.renew_noise(unnamed);
  const Drive& drive = problem.drive(0);
  const Seen seen = [&] {
    if (!found.is_named() || found.has_remainder())
      return seen_at(problem, fitted(problem, unnamed, compared(problem, {0}), kFit));
    // The contribution of terms that explain all has no noise.
    Hypothesis bare = unnamed;
    take_values(selection.named, bare);
    return seen_at(problem, bare, selection.named);
  }();
  Where where;
  where.is_of_named = seen.noise.empty();
  where.part = problem.relation().part();
  where.record = problem.record(0).name;
  where.channel = channel_of(problem, seen);
  where.has_time = drive.has_time;
  const Seen rest = drive.has_time ? map_frequency(seen, drive, where) : seen;
  map_time(rest, drive, where);
  if (drive.has_time) map_states(rest, drive, range, where);
  map_other_states(rest, drive, where);
  return where;
}

MatrixXd excess_of(const TestedHypothesis& tested, std::size_t record) {
  const MatrixXd white = tested.whitened(record);
  const Drive& drive = tested.problem().drive(record);
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
