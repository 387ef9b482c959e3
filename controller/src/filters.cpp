// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/filters.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Core>

#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::controller {

Notch::Notch(double frequency, double damping, double depth, double period) {
  if (!(period > 0) || !(frequency > 0) || frequency * period >= 0.5)
    throw Error{fmt::format("notch: a frequency of {} Hz needs a sampling rate above twice that",
                            frequency)};
  if (!(damping > 0) || !(depth >= 0 && depth <= 1))
    throw Error{fmt::format(
        "notch: damping is {} and depth {}, expected a positive damping and a depth of 0 to 1",
        damping, depth)};
  const double k = std::tan(std::numbers::pi * frequency * period);
  const double wide = 2 * damping * k, narrow = depth * wide, norm = 1 / (1 + wide + k * k);
  inputs_ = {(1 + narrow + k * k) * norm, 2 * (k * k - 1) * norm, (1 - narrow + k * k) * norm};
  outputs_ = {1, inputs_[1], (1 - wide + k * k) * norm};
}

double Notch::operator()(double input) noexcept {
  if (!has_started_) {
    z1_ = (1 - inputs_[0]) * input;
    z2_ = (inputs_[2] - outputs_[2]) * input;
    has_started_ = true;
  }
  const double out = inputs_[0] * input + z1_;
  z1_ = inputs_[1] * input - outputs_[1] * out + z2_;
  z2_ = inputs_[2] * input - outputs_[2] * out;
  return out;
}

MovingAverage::MovingAverage(int length) {
  if (length < 1)
    throw Error{fmt::format("moving average: the length is {}, expected at least 1", length)};
  samples_.assign(static_cast<std::size_t>(length), 0.0);
}

// Sums all samples each time: a running sum would accumulate rounding errors.
double MovingAverage::operator()(double input) noexcept {
  samples_[next_] = input;
  next_ = (next_ + 1) % samples_.size();
  count_ = std::min(count_ + 1, samples_.size());
  double sum = 0;
  for (std::size_t i = 0; i < count_; ++i) sum += samples_[i];
  return sum / static_cast<double>(count_);
}

EndSlope::EndSlope(int length, double period) {
  if (length < 3)
    throw Error{fmt::format("slope filter: the length is {}, expected at least 3", length)};
  if (!(period > 0))
    throw Error{
        fmt::format("slope filter: the period is {:g}, expected a positive number", period)};
  // Least-squares parabola over τ = −i·period. Its slope at τ = 0 is row 1 of the pseudo-inverse
  // times the samples.
  Eigen::MatrixXd X(length, 3);
  for (int i = 0; i < length; ++i) {
    const double t = -i * period;
    X.row(i) << 1, t, t * t;
  }
  const Eigen::MatrixXd pseudo_inverse =
      maths::solve_least_squares(X, Eigen::MatrixXd{Eigen::MatrixXd::Identity(length, length)});
  for (int i = 0; i < length; ++i) weights_.push_back(pseudo_inverse(1, i));
  samples_.assign(static_cast<std::size_t>(length), 0.0);
}

double EndSlope::operator()(double input) noexcept {
  samples_[next_] = input;
  next_ = (next_ + 1) % samples_.size();
  count_ = std::min(count_ + 1, samples_.size());
  if (count_ < samples_.size()) return 0;
  double slope = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::size_t newest_first = (next_ + samples_.size() - 1 - i) % samples_.size();
    slope += weights_[i] * samples_[newest_first];
  }
  return slope;
}

}  // namespace rths::controller
