// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/ats.hpp>

#include <cmath>

#include <Eigen/Cholesky>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

AtsSettings checked(const AtsSettings& settings) {
  const Require require{"ATS"};
  require.positive("period", settings.period);
  require(settings.decimation >= 1, "decimation", settings.decimation, "at least 1");
  require(settings.window >= 4 * settings.decimation * settings.period, "window", settings.window,
          "at least four samples, each of 'decimation' periods");
  for (Eigen::Index i = 0; i < settings.lowest.size(); ++i) {
    require(settings.lowest[i] <= settings.highest[i], "the lowest value of a range",
            settings.lowest[i], "at most its highest");
    require.positive("largest change per sample", settings.largest_change[i]);
  }
  return settings;
}

// The columns differ by powers of the frequency; scaling them to equal length keeps the solution's
// precision.
Eigen::Vector3d solve_scaled(const Eigen::Matrix3d& A, const Eigen::Vector3d& b) {
  const Eigen::Vector3d scale = A.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d scaled = scale.asDiagonal() * A * scale.asDiagonal();
  const Eigen::Vector3d rhs = scale.cwiseProduct(b);
  return scale.cwiseProduct(scaled.ldlt().solve(rhs));
}

}  // namespace

Ats::Ats(const AtsSettings& settings)
    : settings_{checked(settings)},
      command_filter_{settings.filter_order, settings.filter_cutoff, settings.period},
      response_filter_{settings.filter_order, settings.filter_cutoff, settings.period},
      smoothing_{settings.smoothing},
      a_{settings.initial} {
  const auto decimation = static_cast<std::size_t>(settings.decimation);
  const auto in_window = static_cast<std::size_t>(std::lround(settings.window / settings.period));
  samples_.resize(in_window / decimation * decimation);
}

void Ats::remember(const Sample& sample) noexcept {
  samples_[next_] = sample;
  next_ = (next_ + 1) % samples_.size();
}

// Sums all samples each time (60 samples in a fraction of a microsecond): running sums would
// accumulate rounding errors after a spike.
void Ats::adapt_coefficients() noexcept {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  const auto stride = static_cast<std::size_t>(settings_.decimation);
  for (std::size_t back = 1; back <= samples_.size(); back += stride) {
    const Sample& sample = samples_[(next_ + samples_.size() - back) % samples_.size()];
    A += sample.x * sample.x.transpose();
    b += sample.u * sample.x;
  }
  const std::size_t count = samples_.size() / stride;
  if (A(0, 0) < static_cast<double>(count) * settings_.quiet_rms * settings_.quiet_rms) return;
  const Eigen::Vector3d fitted = solve_scaled(A, b);
  const Eigen::Vector3d wanted = fitted.allFinite() ? fitted : settings_.initial;
  const Eigen::Vector3d slowed =
      wanted.cwiseMax(a_ - settings_.largest_change).cwiseMin(a_ + settings_.largest_change);
  a_ = slowed.cwiseMax(settings_.lowest).cwiseMin(settings_.highest);
  if (a_ != wanted) ++limited_;
}

double Ats::step(const Eigen::Vector3d& command, double measured, double share,
                 bool adapt) noexcept {
  if (command.allFinite()) last_command_ = command;
  if (std::isfinite(measured)) last_measured_ = measured;
  const double response = response_filter_(last_measured_);
  triggered_ = triggered_ || std::abs(response) > settings_.threshold;
  if (triggered_ && adapt) adapt_coefficients();  // the fit uses earlier samples only

  const double reference = (1 - share) * last_command_[0] + share * a_.dot(last_command_);

  const double difference = (response - previous_) / settings_.period;
  const double second = (difference - previous_difference_) / settings_.period;
  previous_ = response;
  previous_difference_ = difference;
  remember({{response, difference, second}, command_filter_(reference)});
  return smoothing_(reference);
}

}  // namespace rths::controller
