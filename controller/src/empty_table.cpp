// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/empty_table.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Core>

#include <fmt/format.h>

#include <rths/algebra/decompositions.hpp>
#include <rths/controller/robust_covariance.hpp>
#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr double kSlopeReach = 0.016;   // of the parabola that gives the velocity, either side [s]
constexpr double kSmoothReach = 0.020;  // of the smoothing window, either side [s]
constexpr double kSlowShare = 0.03;     // of the largest speed: slower samples are left out
constexpr double kLoadSpread = 0.05;    // of the mean load: less does not determine μ
constexpr double kLeastLoad = 1e3;      // its deviation: friction is a small part of it [N]
constexpr double kLeastRate = 0.01;     // [m/s]: slower records are refused
constexpr double kLongestDelay = 0.05;  // of the accelerometer [s]
constexpr Eigen::Index kMostLags = 50;  // of the correlation of the residual [fitted samples]
constexpr std::size_t kTestedLags = 20;
constexpr std::size_t kLeastSamples = 50;

enum Column : Eigen::Index {
  kMassColumn,
  kCoulombColumn,
  kLoadColumn,
  kViscousColumn,
  kOffsetColumn,
  kDelayColumn,
  kColumns
};

double direction_of(double velocity) { return velocity > 0 ? 1.0 : (velocity < 0 ? -1.0 : 0.0); }

std::size_t samples(double seconds, double period) {
  return static_cast<std::size_t>(std::max(2L, std::lround(seconds / period)));
}

// Slope of the parabola through a sample and its neighbours. Near the ends: 0.
std::vector<double> central_slope(const std::vector<double>& x, std::size_t reach, double period) {
  const auto n = static_cast<double>(reach);
  const double weight = 1 / (period * n * (n + 1) * (2 * n + 1) / 3);
  std::vector<double> slope(x.size(), 0.0);
  for (std::size_t i = reach; i + reach < x.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 1; k <= reach; ++k) sum += static_cast<double>(k) * (x[i + k] - x[i - k]);
    slope[i] = weight * sum;
  }
  return slope;
}

/// Signals of a record at its full rate.
struct Motion {
  double period = 0;
  std::size_t reach = 0;  ///< samples lost at either end
  std::vector<double> acceleration, velocity, load, force;
  std::vector<bool> moves;  ///< fast enough for the sign of its velocity to be certain
};

Motion motion_of(const EmptyTableRecord& record) {
  const std::size_t size = record.force.size();
  if (record.displacement.size() != size || record.acceleration.size() != size ||
      (!record.load.empty() && record.load.size() != size))
    throw Error{"empty table: the measured signals differ in length"};
  Motion motion;
  motion.period = record.period;
  const std::size_t slope = samples(kSlopeReach, record.period);
  motion.reach =
      slope + samples(kSmoothReach, record.period) + samples(kLongestDelay, record.period);
  if (size < 10 * motion.reach)
    throw Error{fmt::format("empty table: {:.3g} s recorded, expected at least {:.3g} s",
                            static_cast<double>(size) * record.period,
                            static_cast<double>(10 * motion.reach) * record.period)};
  motion.acceleration = record.acceleration;
  motion.force = record.force;
  motion.load = record.load.empty() ? std::vector<double>(size, 0.0) : record.load;
  motion.velocity = central_slope(record.displacement, slope, record.period);
  double fastest = 0;
  for (const double v : motion.velocity) fastest = std::max(fastest, std::abs(v));
  const double slow = std::max(kSlowShare * fastest, 1e-3 * kLeastRate);
  for (const double v : motion.velocity)
    motion.moves.push_back(fastest >= kLeastRate && std::abs(v) >= slow);
  return motion;
}

/// Mean over a Hann window.
class Smoothing {
 public:
  explicit Smoothing(std::size_t reach) : reach_{reach} {
    double sum = 0;
    for (std::size_t k = 0; k <= 2 * reach; ++k) {
      weight_.push_back(1 - std::cos(2 * std::numbers::pi * (static_cast<double>(k) + 1) /
                                     static_cast<double>(2 * reach + 2)));
      sum += weight_.back();
    }
    for (double& weight : weight_) weight /= sum;
  }
  [[nodiscard]] std::size_t reach() const { return reach_; }
  template <class Value>
  [[nodiscard]] double operator()(std::size_t at, Value value) const {
    double sum = 0;
    for (std::size_t k = 0; k < weight_.size(); ++k) sum += weight_[k] * value(at + k - reach_);
    return sum;
  }

 private:
  std::size_t reach_;
  std::vector<double> weight_;
};

// Linear between samples; the smoothing that follows makes the error of that negligible.
double at(const std::vector<double>& x, double position) {
  const double last = static_cast<double>(x.size()) - 1.001;
  const double p = std::clamp(position, 0.0, last);
  const auto i = static_cast<std::size_t>(p);
  const double part = p - static_cast<double>(i);
  return (1 - part) * x[i] + part * x[i + 1];
}

/// Smoothed samples of all records.
struct TableRows {
  Eigen::MatrixXd features;  ///< kColumns − 1 columns: all but the delay
  Eigen::VectorXd rate;      ///< of the smoothed acceleration [m/s³]
  Eigen::VectorXd force;
};

void append(const Motion& motion, double delay,
            std::vector<std::array<double, kColumns + 1>>& rows) {
  const Smoothing smooth{samples(kSmoothReach, motion.period)};
  const double shift = delay / motion.period;
  for (std::size_t i = motion.reach; i + motion.reach < motion.force.size();
       i += 2 * smooth.reach()) {
    const double direction = direction_of(motion.velocity[i]);
    bool steady = true;
    for (std::size_t k = i - smooth.reach(); steady && k <= i + smooth.reach(); ++k)
      steady = motion.moves[k] && direction_of(motion.velocity[k]) == direction;
    if (!steady) continue;
    const auto acceleration = [&](double offset) {
      return smooth(i, [&](std::size_t k) {
        return at(motion.acceleration, static_cast<double>(k) + shift + offset);
      });
    };
    const double load = smooth(i, [&](std::size_t k) { return motion.load[k]; });
    rows.push_back({acceleration(0), direction, load * direction,
                    smooth(i, [&](std::size_t k) { return motion.velocity[k]; }), 1,
                    (acceleration(1) - acceleration(-1)) / (2 * motion.period),
                    smooth(i, [&](std::size_t k) { return motion.force[k]; })});
  }
}

TableRows rows_of(const std::vector<Motion>& motions, double delay) {
  std::vector<std::array<double, kColumns + 1>> all;
  for (const auto& motion : motions) append(motion, delay, all);
  if (all.size() < kLeastSamples)
    throw Error{fmt::format(
        "empty table: {} usable samples, expected at least {}: the table has to move at more than "
        "{} m/s",
        all.size(), kLeastSamples, kLeastRate)};
  const auto count = static_cast<Eigen::Index>(all.size());
  TableRows rows{Eigen::MatrixXd(count, kDelayColumn), Eigen::VectorXd(count),
                 Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& row = all[static_cast<std::size_t>(i)];
    for (Eigen::Index column = 0; column < kDelayColumn; ++column)
      rows.features(i, column) = row[static_cast<std::size_t>(column)];
    rows.rate[i] = row[kDelayColumn];
    rows.force[i] = row[kColumns];
  }
  return rows;
}

/// Values of all columns, and which of them are fitted.
struct TableSolution {
  Eigen::VectorXd value = Eigen::VectorXd::Zero(kColumns);
  std::vector<Eigen::Index> fitted;
};

Eigen::MatrixXd design(const TableRows& rows, const std::vector<Eigen::Index>& fitted,
                       double mass) {
  Eigen::MatrixXd jacobian(rows.force.size(), static_cast<Eigen::Index>(fitted.size()));
  for (std::size_t i = 0; i < fitted.size(); ++i)
    jacobian.col(static_cast<Eigen::Index>(i)) = fitted[i] == kDelayColumn
                                                     ? Eigen::VectorXd(mass * rows.rate)
                                                     : rows.features.col(fitted[i]);
  return jacobian;
}

// The delay enters as m_e τ, which is linear near the present delay.
void solve(const TableRows& rows, TableSolution& solution) {
  const Eigen::MatrixXd jacobian = design(rows, solution.fitted, 1);
  const Eigen::VectorXd size = jacobian.colwise().norm();
  if (!(size.minCoeff() > 0))
    throw Error{"empty table: the records do not excite inertia and friction"};
  const Eigen::VectorXd scaled =
      algebra::solve_least_squares(jacobian * size.cwiseInverse().asDiagonal(), rows.force);
  solution.value.setZero();
  for (std::size_t i = 0; i < solution.fitted.size(); ++i)
    solution.value[solution.fitted[i]] =
        scaled[static_cast<Eigen::Index>(i)] / size[static_cast<Eigen::Index>(i)];
}

// Covariance of the fitted columns.
Eigen::MatrixXd covariance_of(const TableRows& rows, const TableSolution& solution) {
  const Eigen::VectorXd residual = rows.force - rows.features * solution.value.head(kDelayColumn) -
                                   solution.value[kDelayColumn] * rows.rate;
  return robust_covariance(design(rows, solution.fitted, solution.value[kMassColumn]), residual,
                           correlated_lags(residual, kMostLags));
}

// Friction is not negative: a negative term is set to zero and the others are fitted again. The
// interval of such a term reaches to the upper end of its interval in the free fit.
Eigen::VectorXd solve_constrained(const TableRows& rows, TableSolution& solution) {
  Eigen::VectorXd half_width = Eigen::VectorXd::Zero(kColumns);
  for (;;) {
    solve(rows, solution);
    const Eigen::MatrixXd covariance = covariance_of(rows, solution);
    std::optional<std::size_t> negative;
    for (std::size_t i = 0; i < solution.fitted.size(); ++i) {
      const auto index = static_cast<Eigen::Index>(i), column = solution.fitted[i];
      // Without a term at its bound the others only seem better known.
      half_width[column] =
          std::max(half_width[column], kHalfWidth95 * std::sqrt(covariance(index, index)));
      const bool is_friction =
          column == kCoulombColumn || column == kLoadColumn || column == kViscousColumn;
      if (is_friction && solution.value[column] < 0) negative = i;
    }
    if (!negative) return half_width;
    const auto column = solution.fitted[*negative];
    half_width[column] = std::max(0.0, solution.value[column] + half_width[column]);
    solution.fitted.erase(solution.fitted.begin() + static_cast<long>(*negative));
  }
}

// Load of the fitted samples: its mean, and whether it varies.
void describe_load(const TableRows& rows, EmptyTableFit& fit) {
  const Eigen::ArrayXd load = rows.features.col(kLoadColumn).cwiseAbs();
  fit.mean_load = load.mean();
  const double deviation = std::sqrt((load - fit.mean_load).square().mean());
  fit.load_varies = deviation > std::max(kLoadSpread * fit.mean_load, kLeastLoad);
}

void describe_residual(const Eigen::VectorXd& residual, EmptyTableFit& fit) {
  const auto count = static_cast<double>(residual.size());
  fit.residual_rms = std::sqrt(residual.squaredNorm() / count);
  fit.residual_peak = residual.cwiseAbs().maxCoeff();
  fit.neighbour_correlation = autocorrelation(residual, 1);
  std::size_t beyond = 0;
  for (std::size_t lag = 1; lag <= kTestedLags; ++lag)
    if (std::abs(autocorrelation(residual, static_cast<Eigen::Index>(lag))) >
        kHalfWidth95 / std::sqrt(count))
      ++beyond;
  fit.correlated_share = static_cast<double>(beyond) / kTestedLags;
}

void describe_raw(const std::vector<Motion>& motions, EmptyTableFit& fit) {
  double squares = 0, count = 0;
  for (const auto& motion : motions) {
    const double shift = fit.acceleration_delay.value / motion.period;
    for (std::size_t i = motion.reach; i + motion.reach < motion.force.size(); ++i) {
      const double a = at(motion.acceleration, static_cast<double>(i) + shift);
      const double error = motion.force[i] - fit.machine(motion.load[i])(motion.velocity[i], a);
      squares += error * error;
      fit.raw_peak = std::max(fit.raw_peak, std::abs(error));
      fit.largest_speed = std::max(fit.largest_speed, std::abs(motion.velocity[i]));
      fit.largest_acceleration =
          std::max(fit.largest_acceleration, std::abs(motion.acceleration[i]));
      ++count;
    }
  }
  fit.raw_rms = std::sqrt(squares / count);
}

}  // namespace

MachineForce EmptyTableFit::machine(double load) const {
  MachineForce machine;
  machine.effective_mass = effective_mass.value;
  machine.coulomb_friction = coulomb_friction.value + load_coefficient.value * std::max(load, 0.0);
  machine.viscous_friction = viscous_friction.value;
  machine.offset = offset.value;
  return machine;
}

EmptyTableFit identify_empty_table(std::span<const EmptyTableRecord> records) {
  if (records.empty()) throw Error{"empty table: no record, expected at least one"};
  std::vector<Motion> motions;
  for (const auto& record : records) motions.push_back(motion_of(record));
  EmptyTableFit fit;
  describe_load(rows_of(motions, 0), fit);
  std::vector<Eigen::Index> columns{kMassColumn, kCoulombColumn, kViscousColumn, kOffsetColumn,
                                    kDelayColumn};
  if (fit.load_varies) columns.insert(columns.begin() + 2, kLoadColumn);
  constexpr int kIterations = 4;  // the acceleration is nearly linear over the change of the delay
  TableSolution solution;
  TableRows rows;
  Eigen::VectorXd half_width;
  double delay = 0;
  for (int i = 0; i < kIterations; ++i) {
    rows = rows_of(motions, delay);
    solution.fitted = columns;
    half_width = solve_constrained(rows, solution);
    const double mass = solution.value[kMassColumn];
    if (!(mass > 0)) throw Error{"empty table: the force does not rise with the acceleration"};
    delay = std::clamp(delay + solution.value[kDelayColumn] / mass, -kLongestDelay, kLongestDelay);
  }
  const std::array<Estimate*, kColumns> estimates{&fit.effective_mass,   &fit.coulomb_friction,
                                                  &fit.load_coefficient, &fit.viscous_friction,
                                                  &fit.offset,           &fit.acceleration_delay};
  for (Eigen::Index column = 0; column < kColumns; ++column)
    *estimates[static_cast<std::size_t>(column)] = {solution.value[column], half_width[column]};
  fit.acceleration_delay.value = delay;
  describe_residual(rows.force - rows.features * solution.value.head(kDelayColumn) -
                        solution.value[kDelayColumn] * rows.rate,
                    fit);
  describe_raw(motions, fit);
  return fit;
}

}  // namespace rths::controller
