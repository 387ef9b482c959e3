// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/table_force.hpp>

#include <cmath>
#include <numbers>

#include <rths/core/error.hpp>
#include <rths/maths/low_pass.hpp>

#include "table_signals.hpp"

namespace rths::controller {
namespace {

constexpr int kObserverFilterOrder = 2;

constexpr Require kRequireTable{"table force"};

TableForce checked(const TableForce& machine) {
  kRequireTable(machine.presliding > 0, "presliding length", machine.presliding,
                "a positive length");
  kRequireTable(machine.effective_mass >= 0, "effective mass", machine.effective_mass, "0 or more");
  kRequireTable(std::isfinite(machine.coulomb_friction + machine.load_friction +
                              machine.viscous_friction + machine.offset + machine.effective_mass),
                "sum of the coefficients", std::nan(""), "finite numbers");
  return machine;
}

bool is_finite(const TableSample& s) {
  return std::isfinite(s.displacement) && std::isfinite(s.acceleration) && std::isfinite(s.force) &&
         std::isfinite(s.axial_load);
}

}  // namespace

FractionalDelay::FractionalDelay(double delay, double period) {
  kRequireTable(delay >= 0 && delay <= kLongestAccelerometerDelay,
                "accelerometer delay, with or without displacement lead,", delay, "0 to 0.02 s");
  kRequireTable.positive("period", period);
  const double samples = delay / period;
  // The four samples around the instant; at the newest end, the four newest.
  whole_ = static_cast<std::size_t>(std::max(0.0, std::floor(samples) - 1));
  const double u = samples - static_cast<double>(whole_);  // 0 at sample whole_, newest first
  for (int i = 0; i < 4; ++i) {
    weights_[static_cast<std::size_t>(i)] = 1;
    for (int j = 0; j < 4; ++j)
      if (j != i) weights_[static_cast<std::size_t>(i)] *= (u - j) / (i - j);
  }
  samples_.assign(whole_ + 4, 0.0);
}

double FractionalDelay::operator()(double input) noexcept {
  if (!started_) samples_.assign(samples_.size(), input);  // same size: no allocation
  started_ = true;
  samples_[next_] = input;
  next_ = (next_ + 1) % samples_.size();
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i)
    sum += weights_[i] * samples_[(next_ + samples_.size() - 1 - whole_ - i) % samples_.size()];
  return sum;
}

// Observer of displacement, velocity and accelerometer bias with a triple pole at −ω.
FusedMotion::FusedMotion(double bandwidth, double period) : period_{period} {
  kRequireTable(bandwidth > 0 && bandwidth * period < 0.05, "velocity bandwidth", bandwidth,
                "between 0 and a twentieth of the sampling rate");
  const double omega = 2 * std::numbers::pi * bandwidth;
  gain_x_ = 3 * omega * period;
  gain_v_ = 3 * omega * omega * period;
  gain_bias_ = omega * omega * omega * period;
}

double FusedMotion::operator()(double displacement, double acceleration) noexcept {
  if (!started_) {
    x_ = displacement;
    last_acceleration_ = acceleration;
  }
  started_ = true;
  // Both samples of the interval, so that the velocity belongs to the newest instant.
  const double a = (acceleration + last_acceleration_) / 2 - bias_;
  last_acceleration_ = acceleration;
  x_ += period_ * (v_ + period_ * a / 2);
  v_ += period_ * a;
  const double innovation = displacement - x_;
  x_ += gain_x_ * innovation;
  v_ += gain_v_ * innovation;
  bias_ -= gain_bias_ * innovation;
  return v_;
}

TableSignals::TableSignals(double accelerometer_delay, double presliding,
                           const TableObserverSettings& settings, int filter_order,
                           double displacement_lead)
    : displacement_{accelerometer_delay + displacement_lead, settings.period},
      force_{accelerometer_delay, settings.period},
      load_{accelerometer_delay, settings.period},
      velocity_{settings.velocity_bandwidth, settings.period},
      presliding_{presliding},
      period_{settings.period} {
  if (filter_order > 0)
    filters_.assign(kTableTerms, maths::LowPass{filter_order, settings.cutoff, settings.period});
}

TableSignals::Terms TableSignals::step(const TableSample& sample) noexcept {
  const double x = displacement_(sample.displacement);
  const double v = velocity_(x, sample.acceleration);
  const double moved = (v + last_velocity_) / 2 * period_;
  last_velocity_ = v;
  const double direction = moved < 0 ? -1 : 1;
  // Exact for motion in one direction.
  friction_state_ =
      direction + (friction_state_ - direction) * std::exp(-std::abs(moved) / presliding_);
  Terms terms;
  terms.displacement = x;
  terms.velocity = v;
  terms.factors << sample.acceleration, friction_state_, load_(sample.axial_load) * friction_state_,
      v, 1;
  terms.force = force_(sample.force);
  if (filters_.empty()) return terms;
  // The constant term passes a low-pass unchanged; its filter takes the force. Filters start at
  // rest, so each gets the difference from its first input.
  terms.factors[kTableOffset] = terms.force;
  if (!first_) first_ = terms.factors;
  for (int i = 0; i < kTableTerms; ++i)
    terms.factors[i] =
        (*first_)[i] + filters_[static_cast<std::size_t>(i)](terms.factors[i] - (*first_)[i]);
  terms.force = terms.factors[kTableOffset];
  terms.factors[kTableOffset] = 1;
  return terms;
}

TableForceObserver::TableForceObserver(const TableForce& machine,
                                       const TableObserverSettings& settings)
    : machine_{checked(machine)},
      signals_{std::make_unique<TableSignals>(
          machine.accelerometer_delay, machine.presliding, settings,
          settings.cutoff > 0 ? kObserverFilterOrder : 0, machine.displacement_lead)},
      lag_{machine.accelerometer_delay} {
  // A Butterworth low-pass of second order delays low frequencies by √2/ω.
  if (settings.cutoff > 0) lag_ += std::numbers::sqrt2 / (2 * std::numbers::pi * settings.cutoff);
}

TableForceObserver::~TableForceObserver() = default;
TableForceObserver::TableForceObserver(TableForceObserver&&) noexcept = default;

double TableForceObserver::step(const TableSample& sample) noexcept {
  if (is_finite(sample))
    last_ = sample;
  else
    ++bad_samples_;
  const TableSignals::Terms terms = signals_->step(last_);
  displacement_ = terms.displacement;
  velocity_ = terms.velocity;
  machine_force_ = terms.factors.dot(Eigen::Matrix<double, TableSignals::kTableTerms, 1>{
      machine_.effective_mass, machine_.coulomb_friction, machine_.load_friction,
      machine_.viscous_friction, machine_.offset});
  return terms.force - machine_force_;
}

}  // namespace rths::controller
