// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Core>

#include <rths/algebra/decompositions.hpp>
#include <rths/controller/robust_covariance.hpp>
#include <rths/controller/table_force.hpp>
#include <rths/core/error.hpp>

#include "table_signals.hpp"

namespace rths::controller {
namespace {

constexpr int kRowFilterOrder = 4;
constexpr double kSettling = 1.0;         // at the start of a run, left out [s]
constexpr double kShortestRun = 5.0;      // [s]
constexpr double kRowsPerCutoff = 4;      // rows per period of the cut-off
constexpr int kCorrelatedRows = 8;        // lag from which residuals count as independent
constexpr double kLeastVariation = 0.02;  // of the axial load, to identify its friction [-]
constexpr double kShortestPresliding = 2e-5, kLongestPresliding = 2e-2;  // [m]
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

class Identification {
 public:
  Identification(std::span<const TableRecording> runs, const TableIdentificationSettings& settings)
      : runs_{runs},
        observer_{settings.period, settings.velocity_bandwidth, settings.cutoff},
        stride_{static_cast<std::size_t>(
            std::max(1L, std::lround(1 / (kRowsPerCutoff * settings.cutoff * settings.period))))} {
    if (runs.empty()) throw Error{"force identification: there is no run"};
    for (std::size_t i = 0; i < runs.size(); ++i) check(runs[i], i, settings.period);
    has_load_ = load_varies();
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
  [[nodiscard]] bool load_varies() const {
    double lowest = 1e300, highest = -1e300;
    for (const auto& run : runs_) {
      if (run.axial_load.empty()) return false;
      for (const double load : run.axial_load) {
        lowest = std::min(lowest, load);
        highest = std::max(highest, load);
      }
    }
    const double largest = std::max(std::abs(lowest), std::abs(highest));
    return highest - lowest > kLeastVariation * largest;
  }

  [[nodiscard]] Rows rows_of(const Shape& shape) const {
    const auto settling = static_cast<std::size_t>(kSettling / observer_.period);
    std::vector<TableSignals::Terms> all;
    for (const auto& run : runs_) {
      TableSignals signals{shape.delay, shape.presliding, observer_, kRowFilterOrder};
      for (std::size_t i = 0; i < run.force.size(); ++i) {
        const auto terms = signals.step({run.displacement[i], run.acceleration[i], run.force[i],
                                         run.axial_load.empty() ? 0 : run.axial_load[i]});
        if (i >= settling && i % stride_ == 0) all.push_back(terms);
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
    const Eigen::VectorXd found = algebra::solve_least_squares(kept, y).cwiseQuotient(scale);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(X.cols());
    for (Eigen::Index i = 0; i < kept.cols(); ++i)
      all[columns[static_cast<std::size_t>(i)]] = found[i];
    return all;
  }

  // Mass and friction are not negative: the most negative one is left out until none is.
  void fit_linear(const Rows& rows) {
    columns_ = {TableSignals::kTableMass, TableSignals::kTableCoulomb, TableSignals::kTableViscous,
                TableSignals::kTableOffset};
    if (has_load_) columns_.push_back(TableSignals::kTableLoad);
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

  [[nodiscard]] std::vector<int> free_columns(const Linearised& at) const {
    std::vector<int> columns = columns_;
    for (const int column : {kParameters - 2, kParameters - 1})
      if (at.J.col(column).norm() > 0) columns.push_back(column);
    return columns;
  }

  bool improve() {
    const Linearised at = linearise();
    const Eigen::VectorXd step = least_squares(at.J, at.residual, free_columns(at));
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

  // Rows of two runs meet at one border each, which is negligible.
  [[nodiscard]] Eigen::VectorXd half_widths(const Linearised& at) const {
    const std::vector<int> columns = free_columns(at);
    const Eigen::MatrixXd covariance =
        robust_covariance(at.J(Eigen::all, columns), at.residual, kCorrelatedRows - 1);
    Eigen::VectorXd widths = Eigen::VectorXd::Zero(kParameters);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      widths[columns[i]] = kHalfWidth95 * std::sqrt(std::max(0.0, covariance(index, index)));
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
    return found;
  }

  std::span<const TableRecording> runs_;
  TableObserverSettings observer_;
  std::size_t stride_;
  bool has_load_ = false;
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
