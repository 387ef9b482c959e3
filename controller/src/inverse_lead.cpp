// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/inverse_lead.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include <rths/core/error.hpp>
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

constexpr Require kRequireLead{"adaptive inverse"};
constexpr double kLargestLoadShare = 0.8;  // of the force capacity

enum Coefficient {
  kPosition,
  kVelocity,
  kAcceleration,
  kJerk,
  kLoad,
  kLoadRate,
  kDeadBand,
  kFlowLoss
};

InverseLeadSettings checked(InverseLeadSettings s) {
  kRequireLead.positive("sign_velocity", s.sign_velocity);
  kRequireLead.positive("force_capacity", s.force_capacity);
  kRequireLead.positive("largest_reference", s.largest_reference);
  kRequireLead(s.effective_mass >= 0, "effective_mass", s.effective_mass, "0 or more");
  return s;
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

InverseLead::Terms InverseLead::vector_of(const InverseCoefficients& c) {
  Terms terms;
  terms << c.a0, c.a1, c.a2, c.a3, c.load, c.load_rate, c.dead_band, c.flow_loss;
  return terms;
}

InverseCoefficients InverseLead::coefficients_of(const Terms& w) {
  return {w[kPosition], w[kVelocity], w[kAcceleration], w[kJerk],
          w[kLoad],     w[kLoadRate], w[kDeadBand],     w[kFlowLoss]};
}

InverseLead::InverseLead(const InverseLeadSettings& settings)
    : settings_{checked(settings)},
      smoothing_{{settings.period, settings.smoothing, settings.average, settings.oil_column}},
      clock_smoothing_{smoothing_},
      force_slope_{settings.force_slope, settings.period} {}

void InverseLead::advance(double target, double force, const Pace& pace) noexcept {
  const double bounded = std::clamp(force, -settings_.force_capacity, settings_.force_capacity);
  const double on_path = target - pace.in_clock;
  if (const auto sample = targets_(on_path, pace.share)) smoothing_.advance(*sample);
  clock_smoothing_.advance(pace.in_clock);
  const TargetSmoothing::Derivatives smoothed =
      pace.lead * smoothing_.smoothed_after(targets_.since() * settings_.period) +
      clock_smoothing_.smoothed();
  TargetSmoothing::Derivatives sharp = smoothing_.sharpened(smoothed);
  sharp[0] += (1 - pace.lead) * on_path;
  sharp.tail<TargetSmoothing::kDerivatives - 2>() *= pace.curvature;
  target_ = target;
  fourth_derivative_ = pace.curvature * smoothed[4];
  // The target's motion one lead time after now, from the smoothed one.
  const double delay = smoothing_.delay();
  const double jerk = pace.curvature * smoothed[3];
  const double acceleration = pace.curvature * smoothed[2] + delay * jerk;
  const double velocity = smoothed[1] + delay * (smoothed[2] + delay / 2 * smoothed[3]) +
                          settings_.lead_time * acceleration;
  if (const auto sample = forces_(bounded, pace.force_share)) force_rate_ = force_slope_(*sample);
  const double force_rate = pace.curvature * force_rate_;
  const double total = bounded + settings_.lead_time * force_rate +
                       settings_.effective_mass * (acceleration + settings_.lead_time * jerk);
  const double used = std::clamp(std::copysign(total, velocity * total) / settings_.force_capacity,
                                 -kLargestLoadShare, kLargestLoadShare);
  terms_ << sharp.head<4>(), bounded, force_rate, std::tanh(velocity / settings_.sign_velocity),
      velocity * (1 / std::sqrt(1 - used) - 1);
}

double InverseLead::reference(const Terms& w, double share) noexcept {
  const double load = w[kLoad] * terms_[kLoad] + w[kLoadRate] * terms_[kLoadRate];
  const double lead = w.head<kLoad>().dot(terms_.head<kLoad>()) +
                      settings_.a4 * fourth_derivative_ + w[kDeadBand] * terms_[kDeadBand] +
                      w[kFlowLoss] * terms_[kFlowLoss] +
                      std::clamp(load, -settings_.largest_load_lead, settings_.largest_load_lead);
  const double wanted = (1 - share) * target_ + share * lead;
  const double clipped =
      std::clamp(wanted, -settings_.largest_reference, settings_.largest_reference);
  is_clipped_ = clipped != wanted || std::abs(load) > settings_.largest_load_lead;
  return clipped;
}

}  // namespace rths::controller
