// SPDX-License-Identifier: Apache-2.0
#include "fading_memory.hpp"

#include <cmath>

#include <Eigen/Core>

#include <rths/maths/decompositions.hpp>

namespace rths::sim {
namespace {

// The rates are evenly spaced in their logarithm. They extend slightly beyond the longest and the
// shortest time, where they still contribute to the kernel.
constexpr double kSlowest = 0.03;  // over 1/longest [-]
constexpr double kFastest = 6;     // over 1/shortest [-]
constexpr Eigen::Index kFitTimes = 300;

// Each exponential relative to the kernel, so that the fit minimises the relative error.
Eigen::MatrixXd shares(const Eigen::ArrayXd& times, const std::vector<double>& rates,
                       double power) {
  Eigen::MatrixXd share(times.size(), static_cast<Eigen::Index>(rates.size()));
  for (Eigen::Index j = 0; j < share.cols(); ++j) {
    const Eigen::ArrayXd x = times * rates[static_cast<std::size_t>(j)];
    share.col(j) = x.pow(power) * (-x).exp();
  }
  return share;
}

}  // namespace

std::vector<FadingExponential> fading_exponentials(double power, double shortest, double longest) {
  const auto evenly = [](double first, double last, Eigen::Index count) -> Eigen::ArrayXd {
    return Eigen::ArrayXd::LinSpaced(count, std::log(first), std::log(last)).exp();
  };
  const Eigen::ArrayXd times = evenly(shortest, longest, kFitTimes);
  const Eigen::ArrayXd all = evenly(kSlowest / longest, kFastest / shortest, kFadingExponentials);
  std::vector<double> rates(all.begin(), all.end());
  Eigen::VectorXd share;
  // Least squares, repeated without the rate of the most negative weight until none is negative.
  while (true) {
    share = maths::solve_least_squares(shares(times, rates, power),
                                       Eigen::VectorXd{Eigen::VectorXd::Ones(kFitTimes)});
    Eigen::Index worst = 0;
    if (share.minCoeff(&worst) >= 0) break;
    rates.erase(rates.begin() + worst);
  }
  std::vector<FadingExponential> exponentials(kFadingExponentials, {1 / longest, 0});
  for (std::size_t i = 0; i < rates.size(); ++i)
    exponentials[i] = {rates[i], share[static_cast<Eigen::Index>(i)] * std::pow(rates[i], power)};
  return exponentials;
}

// The exponentials represent the kernel from one time step on. A step's intake is stored for the
// next step, already decayed to that step's end, where M is evaluated.
void prepare_fading_memory(double power, double time_step, std::span<double> constants) {
  constants[0] = std::pow(time_step, 1 - power) / (1 - power);
  const auto exponentials = fading_exponentials(power, time_step, kLongestMemory + time_step);
  for (std::size_t i = 0; i < kFadingExponentials; ++i) {
    const auto& [rate, weight] = exponentials[i];
    const double decay = std::exp(-rate * time_step);
    constants[1 + i] = decay;
    constants[1 + kFadingExponentials + i] = weight * decay * -std::expm1(-rate * time_step) / rate;
  }
}

}  // namespace rths::sim
