// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Core>

#include <rths/controller/table_force.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/robust_covariance.hpp>
#include <rths/maths/statistics.hpp>

#include "table_signals.hpp"

namespace rths::controller {
namespace {

constexpr int kRowFilterOrder = 4;
constexpr double kSettling = 1.0;     // at the start of a run, left out [s]
constexpr double kShortestRun = 5.0;  // [s]
constexpr double kRowsPerCutoff = 4;  // rows per period of the cut-off
constexpr int kCorrelatedRows = 32;   // of the low-pass: Bartlett's weights then lose 5 %
constexpr double kBlock = 0.04;       // of the means whose correlation is stated [s]
constexpr Eigen::Index kTestedLags = 20;
constexpr double kMotionWindow = 0.25;    // before and after a row that counts [s]
constexpr double kRestShare = 0.02;       // of the largest motion in a window; less is rest
constexpr double kLeastLoadRange = 1e3;   // [N]: friction of less is below any noise
constexpr double kLeastVariation = 0.02;  // of the axial load, to identify its friction [-]
constexpr double kShortestPresliding = 2e-6, kLongestPresliding = 2e-2;  // [m]
constexpr int kIterations = 12;
constexpr int kParameters = TableSignals::kTableTerms + 2;  // with δ and τ_a, in this order

struct Shape {
  double presliding = 1e-3, delay = 0;
};

struct Rows {
  Eigen::MatrixXd factors;
  Eigen::VectorXd force;
};

void check(const TableRecording& run, std::size_t number, double period) {
  const auto fail = [&](const std::string& found) {
    throw Error{fmt::format("force identification: run {}: {}", number + 1, found)};
  };
  const std::size_t length = run.force.size();
  if (run.displacement.size() != length || run.acceleration.size() != length ||
      (!run.axial_load.empty() && run.axial_load.size() != length))
    fail("the measured signals differ in length");
  if (static_cast<double>(length) * period < kSettling + kShortestRun)
    fail(fmt::format("lasts {:.1f} s, expected at least {:.0f} s",
                     static_cast<double>(length) * period, kSettling + kShortestRun));
  for (const auto signal : {run.displacement, run.acceleration, run.force, run.axial_load})
    for (const double value : signal)
      if (!std::isfinite(value)) fail("a measured value is not a finite number");
}

// Standard deviation of each window of n samples, by its first sample.
std::vector<double> window_deviations(std::span<const double> x, std::size_t n) {
  std::vector<double> deviations;
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double value = x[i] - x[0];
    sum += value;
    squares += value * value;
    if (i + 1 < n) continue;
    const double mean = sum / static_cast<double>(n);
    deviations.push_back(std::sqrt(std::max(0.0, squares / static_cast<double>(n) - mean * mean)));
    const double first = x[i + 1 - n] - x[0];
    sum -= first;
    squares -= first * first;
  }
  return deviations;
}

// Whether the table moves before and after a sample. At rest friction can have any value between
// its limits, and the velocity is only noise.
std::vector<bool> moving(std::span<const double> displacement, double period) {
  const auto window = static_cast<std::size_t>(kMotionWindow / period);
  const auto deviations = window_deviations(displacement, window);
  const double rest = kRestShare * *std::ranges::max_element(deviations);
  std::vector<bool> moves(displacement.size(), false);
  for (std::size_t i = window; i < deviations.size(); ++i)
    moves[i] = std::min(deviations[i - window], deviations[i]) > rest;
  return moves;
}

class Identification {
 public:
  Identification(std::span<const TableRecording> runs, const TableIdentificationSettings& settings)
      : runs_{runs},
        observer_{settings.period, settings.velocity_bandwidth, settings.cutoff},
        stride_{static_cast<std::size_t>(
            std::max(1L, std::lround(1 / (kRowsPerCutoff * settings.cutoff * settings.period))))},
        settling_{static_cast<std::size_t>(kSettling / settings.period)} {
    if (runs.empty()) throw Error{"force identification: there is no run"};
    for (std::size_t i = 0; i < runs.size(); ++i) check(runs[i], i, settings.period);
    has_load_ = load_varies();
    behind_ = accelerometer_behind_displacement(runs, settings.period);
  }

  [[nodiscard]] TableIdentification solve() {
    start();
    int iteration = 0;
    for (bool moves = true; moves && iteration < kIterations; ++iteration) moves = improve();
    TableIdentification found = result();
    found.iterations = iteration;
    return found;
  }

 private:
  // Of the samples in motion: a machine may load its guides before the run.
  [[nodiscard]] bool load_varies() const {
    double lowest = 1e300, highest = -1e300;
    for (const auto& run : runs_) {
      if (run.axial_load.empty()) return false;
      const auto moves = moving(run.displacement, observer_.period);
      for (std::size_t i = settling_; i < moves.size(); ++i) {
        if (!moves[i]) continue;
        lowest = std::min(lowest, run.axial_load[i]);
        highest = std::max(highest, run.axial_load[i]);
      }
    }
    const double largest = std::max(std::abs(lowest), std::abs(highest));
    return highest - lowest > std::max(kLeastVariation * largest, kLeastLoadRange);
  }

  [[nodiscard]] static TableSample sample_of(const TableRecording& run, std::size_t i) {
    return {run.displacement[i], run.acceleration[i], run.force[i],
            run.axial_load.empty() ? 0 : run.axial_load[i]};
  }

  [[nodiscard]] Rows rows_of(const Shape& shape) const {
    std::vector<TableSignals::Terms> all;
    for (const auto& run : runs_) {
      TableSignals signals{shape.delay, shape.presliding, observer_, kRowFilterOrder,
                           lead_at(shape)};
      const auto moves = moving(run.displacement, observer_.period);
      for (std::size_t i = 0; i < run.force.size(); ++i) {
        const auto terms = signals.step(sample_of(run, i));
        if (i >= settling_ && i % stride_ == 0 && moves[i]) all.push_back(terms);
      }
    }
    Rows rows{
        Eigen::MatrixXd(static_cast<Eigen::Index>(all.size()), int{TableSignals::kTableTerms}),
        Eigen::VectorXd(static_cast<Eigen::Index>(all.size()))};
    for (std::size_t i = 0; i < all.size(); ++i) {
      rows.factors.row(static_cast<Eigen::Index>(i)) = all[i].factors.transpose();
      rows.force[static_cast<Eigen::Index>(i)] = all[i].force;
    }
    return rows;
  }

  // Least squares over some columns, scaled to equal length; the others are zero.
  [[nodiscard]] static Eigen::VectorXd least_squares(const Eigen::MatrixXd& X,
                                                     const Eigen::VectorXd& y,
                                                     const std::vector<int>& columns) {
    Eigen::MatrixXd kept(X.rows(), static_cast<Eigen::Index>(columns.size()));
    Eigen::VectorXd scale(kept.cols());
    for (Eigen::Index i = 0; i < kept.cols(); ++i) {
      scale[i] = X.col(columns[static_cast<std::size_t>(i)]).norm();
      if (!(scale[i] > 0))
        throw Error{"force identification: the runs do not excite inertia and friction"};
      kept.col(i) = X.col(columns[static_cast<std::size_t>(i)]) / scale[i];
    }
    const Eigen::VectorXd found = maths::solve_least_squares(kept, y).cwiseQuotient(scale);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(X.cols());
    for (Eigen::Index i = 0; i < kept.cols(); ++i)
      all[columns[static_cast<std::size_t>(i)]] = found[i];
    return all;
  }

  [[nodiscard]] std::vector<int> linear_columns() const {
    std::vector<int> columns = {TableSignals::kTableMass, TableSignals::kTableCoulomb,
                                TableSignals::kTableViscous, TableSignals::kTableOffset};
    if (has_load_) columns.push_back(TableSignals::kTableLoad);
    return columns;
  }

  // Mass and friction are not negative: the most negative one is left out until none is.
  void fit_linear(const Rows& rows) {
    columns_ = linear_columns();
    for (;;) {
      linear_ = least_squares(rows.factors, rows.force, columns_);
      int worst = -1;
      for (int term = 0; term < TableSignals::kTableOffset; ++term)
        if (linear_[term] < 0 && (worst < 0 || linear_[term] * rows.factors.col(term).norm() <
                                                   linear_[worst] * rows.factors.col(worst).norm()))
          worst = term;
      if (worst < 0) return;
      if (worst == TableSignals::kTableMass)
        throw Error{
            "force identification: the mass is negative: the force or the acceleration has "
            "the wrong sign"};
      std::erase(columns_, worst);
    }
  }

  [[nodiscard]] double error_of(const Shape& shape) {
    const Rows rows = rows_of(shape);
    fit_linear(rows);
    return (rows.force - rows.factors * linear_).norm();
  }

  // Gauss-Newton needs a start near the best shape: the best point of a coarse grid.
  void start() {
    double best = 1e300;
    for (const double delay : {0.0, 0.003, 0.008, 0.015})
      for (const double presliding : {1e-4, 1e-3, 5e-3})
        if (const double error = error_of({presliding, delay}); error < best) {
          best = error;
          shape_ = {presliding, delay};
        }
  }

  // The linear terms and the two derivatives of the residual by the shape.
  struct Linearised {
    Rows rows;
    Eigen::MatrixXd J;  ///< rows × parameters
    Eigen::VectorXd residual;
  };
  [[nodiscard]] Linearised linearise() {
    Linearised at{rows_of(shape_), {}, {}};
    fit_linear(at.rows);
    at.residual = at.rows.force - at.rows.factors * linear_;
    const double stretch = 0.02 * shape_.presliding;
    const double shift = shape_.delay > kLongestAccelerometerDelay / 2 ? -1e-4 : 1e-4;
    const Rows longer = rows_of({shape_.presliding + stretch, shape_.delay});
    const Rows later = rows_of({shape_.presliding, shape_.delay + shift});
    at.J.resize(at.rows.factors.rows(), kParameters);
    at.J << at.rows.factors, -((longer.force - longer.factors * linear_) - at.residual) / stretch,
        -((later.force - later.factors * linear_) - at.residual) / shift;
    return at;
  }

  [[nodiscard]] static std::vector<int> with_shape(std::vector<int> columns, const Linearised& at) {
    for (const int column : {kParameters - 2, kParameters - 1})
      if (at.J.col(column).norm() > 0) columns.push_back(column);
    return columns;
  }

  bool improve() {
    const Linearised at = linearise();
    const Eigen::VectorXd step = least_squares(at.J, at.residual, with_shape(columns_, at));
    const Shape before = shape_;
    const double error = at.residual.norm();
    double share = 1;
    for (int halving = 0; halving < 5; ++halving, share /= 2) {
      shape_.presliding = std::clamp(before.presliding + share * step[kParameters - 2],
                                     std::max(kShortestPresliding, before.presliding / 3),
                                     std::min(kLongestPresliding, before.presliding * 3));
      shape_.delay =
          std::clamp(before.delay + share * step[kParameters - 1], 0.0, kLongestAccelerometerDelay);
      if (error_of(shape_) <= error)
        return std::abs(shape_.presliding - before.presliding) > 1e-4 * before.presliding ||
               std::abs(shape_.delay - before.delay) > 1e-7;
    }
    shape_ = before;
    return false;
  }

  // Rows of two runs meet at one border each, which is negligible. The interval of a friction that
  // is left out reaches from 0 to the upper end of its interval in the free fit.
  [[nodiscard]] Eigen::VectorXd half_widths(const Linearised& at) const {
    const std::vector<int> columns = with_shape(linear_columns(), at);
    const Eigen::MatrixXd covariance =
        maths::robust_covariance(at.J(Eigen::all, columns), at.residual, kCorrelatedRows - 1);
    const Eigen::VectorXd free = least_squares(at.J, at.residual, columns);
    Eigen::VectorXd widths = Eigen::VectorXd::Zero(kParameters);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      const int column = columns[i];
      widths[column] = maths::kHalfWidth95 * std::sqrt(std::max(0.0, covariance(index, index)));
      if (std::ranges::count(columns_, column) == 0 && column < TableSignals::kTableTerms)
        widths[column] = std::max(0.0, free[column] + widths[column]);
    }
    return widths;
  }

  [[nodiscard]] static TableForce table_force(const Eigen::VectorXd& linear, const Shape& shape) {
    return {linear[TableSignals::kTableMass],
            linear[TableSignals::kTableCoulomb],
            linear[TableSignals::kTableLoad],
            linear[TableSignals::kTableViscous],
            linear[TableSignals::kTableOffset],
            shape.presliding,
            shape.delay};
  }

  [[nodiscard]] TableIdentification result() {
    const Linearised at = linearise();
    const Eigen::VectorXd widths = half_widths(at);
    TableIdentification found;
    found.machine = table_force(linear_, shape_);
    found.half_width = table_force(widths, {widths[kParameters - 2], widths[kParameters - 1]});
    found.has_load_friction = has_load_;
    found.residual_rms = std::sqrt(at.residual.squaredNorm() /
                                   static_cast<double>(at.residual.size() - kParameters));
    found.residual_peak = at.residual.cwiseAbs().maxCoeff();
    found.machine.displacement_lead = lead_at(shape_);
    found.half_width.displacement_lead =
        std::hypot(behind_.half_width, found.half_width.accelerometer_delay);
    describe_samples(found);
    return found;
  }

  // So that the displacement waits as long as the accelerometer is behind it, whatever the shape.
  [[nodiscard]] double lead_at(const Shape& shape) const {
    return std::clamp(behind_.value, 0.0, kLongestAccelerometerDelay) - shape.delay;
  }

  // Every sample in motion, without the low-pass.
  void describe_samples(TableIdentification& found) const {
    double squares = 0, samples = 0, block = 0;
    int in_block = 0;
    std::vector<double> blocks;
    for (const auto& run : runs_) {
      const auto moves = moving(run.displacement, observer_.period);
      TableSignals signals{shape_.delay, shape_.presliding, observer_, 0, lead_at(shape_)};
      for (std::size_t i = 0; i < run.force.size(); ++i) {
        const TableSample sample = sample_of(run, i);
        const auto terms = signals.step(sample);
        if (!moves[i] || i < settling_) continue;
        const double left = terms.force - terms.factors.dot(linear_);
        squares += left * left;
        ++samples;
        found.sample_peak = std::max(found.sample_peak, std::abs(left));
        found.largest_speed = std::max(found.largest_speed, std::abs(terms.velocity));
        found.mean_load += sample.axial_load;
        block += left;
        if (++in_block * observer_.period < kBlock) continue;
        blocks.push_back(block / in_block);
        block = in_block = 0;
      }
    }
    found.sample_rms = std::sqrt(squares / samples);
    found.mean_load /= samples;
    describe_correlation(blocks, found);
  }

  static void describe_correlation(const std::vector<double>& blocks, TableIdentification& found) {
    const Eigen::Map<const Eigen::VectorXd> means{blocks.data(),
                                                  static_cast<Eigen::Index>(blocks.size())};
    if (means.size() <= 2 * kTestedLags) return;
    const double bound = maths::kHalfWidth95 / std::sqrt(static_cast<double>(means.size()));
    int beyond = 0;
    for (Eigen::Index lag = 1; lag <= kTestedLags; ++lag)
      if (std::abs(maths::autocorrelation(means, lag)) > bound) ++beyond;
    found.neighbour_correlation = maths::autocorrelation(means, 1);
    found.correlated_share = static_cast<double>(beyond) / kTestedLags;
  }

  std::span<const TableRecording> runs_;
  TableObserverSettings observer_;
  std::size_t stride_, settling_;
  bool has_load_ = false;
  maths::RobustEstimate behind_;  ///< the accelerometer behind the displacement transducer [s]
  Shape shape_;
  Eigen::VectorXd linear_;
  std::vector<int> columns_;
};

}  // namespace

TableIdentification identify_table_force(std::span<const TableRecording> runs,
                                         const TableIdentificationSettings& settings) {
  return Identification{runs, settings}.solve();
}

}  // namespace rths::controller
