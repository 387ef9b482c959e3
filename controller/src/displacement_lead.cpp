// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include <rths/maths/decompositions.hpp>
#include <rths/maths/low_pass.hpp>
#include <rths/maths/robust_covariance.hpp>
#include <rths/maths/statistics.hpp>

#include "table_signals.hpp"

namespace rths::controller {
namespace {

constexpr int kLeadFilterOrder = 4;
// The noise of 50 µm has a second derivative of 0.02 m/s² there, a hundredth of a test's.
constexpr double kLeadCutoff = 8;           // [Hz]
constexpr double kLeadSettling = 1;         // of the low-passes, left out [s]
constexpr double kRowsPerLeadCutoff = 4;    // rows per period of the cut-off
constexpr Eigen::Index kMostLeadLags = 31;  // of the residual's correlation
enum LeadColumn { kSecond, kThird, kConstant, kColumns };

std::vector<double> filtered(std::span<const double> signal, double period) {
  std::vector<double> result{signal.begin(), signal.end()};
  for (double& value : result) value -= signal.front();  // the low-pass starts at rest
  maths::LowPass{kLeadFilterOrder, kLeadCutoff, period}.filter(result);
  return result;
}

}  // namespace

maths::RobustEstimate accelerometer_behind_displacement(std::span<const TableRecording> runs,
                                                        double period) {
  const auto stride = static_cast<std::size_t>(
      std::max(1L, std::lround(1 / (kRowsPerLeadCutoff * kLeadCutoff * period))));
  std::vector<Eigen::Vector4d> rows;
  for (const auto& run : runs) {
    const auto x = filtered(run.displacement, period), a = filtered(run.acceleration, period);
    for (auto i = static_cast<std::size_t>(kLeadSettling / period) + 2; i + 2 < x.size();
         i += stride)
      rows.emplace_back(
          (x[i + 1] - 2 * x[i] + x[i - 1]) / std::pow(period, 2),
          (x[i + 2] - 2 * x[i + 1] + 2 * x[i - 1] - x[i - 2]) / 2 / std::pow(period, 3), 1, a[i]);
  }
  Eigen::MatrixXd X(static_cast<Eigen::Index>(rows.size()), int{kColumns});
  Eigen::VectorXd y(X.rows());
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    X.row(i) = rows[static_cast<std::size_t>(i)].head<kColumns>().transpose();
    y[i] = rows[static_cast<std::size_t>(i)][kColumns];
  }
  if (!(X.col(kSecond).norm() > 0)) return {};
  const Eigen::VectorXd c = maths::solve_least_squares(X, y);
  const Eigen::MatrixXd covariance = maths::robust_covariance(X, y - X * c, kMostLeadLags);
  // With k, the ratio of the calibrations: a(t) = k ẍ(t − τ), to first order k ẍ − k τ x⃛.
  const double deviation = std::sqrt(std::max(0.0, covariance(kThird, kThird)));
  return {-c[kThird] / c[kSecond], maths::kHalfWidth95 * deviation / std::abs(c[kSecond])};
}

}  // namespace rths::controller
