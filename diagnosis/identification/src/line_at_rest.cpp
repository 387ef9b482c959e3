// SPDX-License-Identifier: Apache-2.0
#include "line_at_rest.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rths/algebra/decompositions.hpp>

#include "transform.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kLeastStretches = 2;
constexpr Index kLeastSamples = 50;       // of a stretch: a sine explains little of fewer by chance
constexpr double kLeastCycles = 2;        // in the shortest stretch: fewer may be drift
constexpr double kLeastLineShare = 0.25;  // of the energy of every stretch
constexpr Index kPadding = 4;             // of transforms, over the longest stretch

VectorXd without_sine(const VectorXd& x, double frequency, double time_step) {
  const VectorXd phase = VectorXd::LinSpaced(x.size(), 0, static_cast<double>(x.size() - 1)) *
                         (2 * std::numbers::pi * frequency * time_step);
  MatrixXd waves(x.size(), 3);
  waves << VectorXd::Ones(x.size()), phase.array().cos().matrix(), phase.array().sin().matrix();
  return x - waves * algebra::solve_least_squares(waves, x);
}

// Smallest share of a sine in the energy of the stretches.
double share_of(const std::vector<VectorXd>& stretches, double frequency, double time_step) {
  double least = 1;
  for (const auto& x : stretches)
    least = std::min(least, 1 - without_sine(x, frequency, time_step).squaredNorm() /
                                    std::max(x.squaredNorm(), 1e-300));
  return least;
}

// Frequency of the highest mean of the periodograms, each over the energy of its stretch.
double highest(const std::vector<VectorXd>& stretches, Index length, double least_frequency,
               double time_step) {
  VectorXd sum = VectorXd::Zero(length / 2);
  for (const auto& x : stretches) {
    VectorXd padded = VectorXd::Zero(length);
    padded.head(x.size()) = x;
    Eigen::VectorXcd bins;
    transformer().fwd(bins, padded);
    sum += bins.head(length / 2).cwiseAbs2() / std::max(x.squaredNorm(), 1e-300);
  }
  const double step = 1 / (static_cast<double>(length) * time_step);
  const auto first =
      std::min(static_cast<Index>(std::ceil(least_frequency / step)), length / 2 - 1);
  Index at = 0;
  sum.tail(sum.size() - first).maxCoeff(&at);
  return static_cast<double>(first + at) * step;
}

}  // namespace

double remove_line(std::vector<VectorXd>& stretches, double time_step) {
  if (stretches.size() < kLeastStretches) return 0;
  const auto [shortest, longest] =
      std::minmax_element(stretches.begin(), stretches.end(),
                          [](const VectorXd& a, const VectorXd& b) { return a.size() < b.size(); });
  if (shortest->size() < kLeastSamples) return 0;
  const double duration = static_cast<double>(shortest->size()) * time_step;
  const Index length = fast_length(kPadding * longest->size());
  const double near = highest(stretches, length, kLeastCycles / duration, time_step);
  double best = 0, frequency = 0;
  for (int k = -4; k <= 4; ++k) {
    const double tried = near + k / 8.0 / (static_cast<double>(length) * time_step);
    const double share = share_of(stretches, tried, time_step);
    if (share > best) best = share, frequency = tried;
  }
  if (best < kLeastLineShare) return 0;
  for (auto& x : stretches) x = without_sine(x, frequency, time_step);
  return frequency;
}

}  // namespace rths::diagnosis
