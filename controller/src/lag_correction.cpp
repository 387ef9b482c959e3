// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/lag_correction.hpp>

#include <cmath>

#include <Eigen/Cholesky>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr double kFirstIsUncertain = 10;  // uncertainty of the first measurement, in noise

double precision_of(double uncertainty) { return 1 / (uncertainty * uncertainty); }

}  // namespace

LagCorrection::LagCorrection(const LagCorrectionSettings& settings)
    : settings_{settings},
      keep_{std::exp(-settings.period / settings.forgetting)},
      prior_{0, 1, settings.lag},
      precision_{precision_of(kFirstIsUncertain * settings.noise),
                 precision_of(settings.gain_uncertainty), precision_of(settings.lag_uncertainty)},
      estimate_{prior_},
      remainder_{2, settings.cutoff, settings.period} {
  const Require require{"lag correction"};
  const auto positive = [&](const char* name, double value) {
    require(value > 0, name, value, "more than 0");
  };
  positive("period", settings.period);
  positive("gain uncertainty", settings.gain_uncertainty);
  positive("lag uncertainty", settings.lag_uncertainty);
  positive("noise", settings.noise);
  positive("forgetting", settings.forgetting);
  require(settings.ahead >= 0, "time ahead", settings.ahead, "0 or more");
}

double LagCorrection::step(double command, double measured, bool adapt) noexcept {
  if (!std::isfinite(command) || !std::isfinite(measured)) return corrected_;
  if (!first_) {
    first_ = {command, measured};
    last_command_ = command;
  }
  const double rate = (command - last_command_) / settings_.period;
  last_command_ = command;
  const double change = command - first_->x();
  if (adapt) learn({1, change, -rate}, measured - first_->y());
  const double remainder = measured - first_->y() - gain() * change + lag() * rate;
  corrected_ = first_->y() + change + settings_.ahead * rate + remainder_(remainder);
  return corrected_;
}

// Bayesian least squares with a memory that fades: without motion, the estimate returns to the
// prior.
void LagCorrection::learn(const Eigen::Vector3d& terms, double measured) noexcept {
  const double weight = precision_of(settings_.noise);
  normal_ = keep_ * normal_ + weight * terms * terms.transpose();
  side_ = keep_ * side_ + weight * measured * terms;
  const Eigen::Matrix3d matrix = normal_ + Eigen::Matrix3d{precision_.asDiagonal()};
  // Rows and columns of unit diagonal: the terms differ by many orders of magnitude.
  const Eigen::Vector3d scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::Vector3d right = scale.cwiseProduct(side_ + precision_.cwiseProduct(prior_));
  const Eigen::Vector3d found = scale.cwiseProduct(scaled.ldlt().solve(right));
  if (found.allFinite()) estimate_ = found;
}

}  // namespace rths::controller
