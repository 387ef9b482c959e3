// SPDX-License-Identifier: Apache-2.0
#include "line_at_rest.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rths/identification/constants.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/fourier.hpp>

namespace rths::diagnosis {
namespace {

VectorXd without_sine(const Stretch& stretch, double frequency) {
  const auto& [x, time_step] = stretch;
  const VectorXd phase = VectorXd::LinSpaced(x.size(), 0, static_cast<double>(x.size() - 1)) *
                         (2 * std::numbers::pi * frequency * time_step);
  MatrixXd waves(x.size(), 3);
  waves << VectorXd::Ones(x.size()), phase.array().cos().matrix(), phase.array().sin().matrix();
  return x - waves * maths::solve_least_squares(waves, x);
}

// Smallest share of a sine in the energy of the stretches.
double share_of(const std::vector<Stretch>& stretches, double frequency) {
  double least = 1;
  for (const auto& stretch : stretches)
    least = std::min(least, 1 - without_sine(stretch, frequency).squaredNorm() /
                                    std::max(stretch.samples.squaredNorm(), 1e-300));
  return least;
}

double duration_of(const Stretch& stretch) {
  return static_cast<double>(stretch.samples.size()) * stretch.time_step;
}

// Length of the transform of a stretch that resolves a duration.
Index length_for(double duration, const Stretch& stretch) {
  return maths::fast_length(static_cast<Index>(
      std::llround(static_cast<double>(kZeroPadding) * duration / stretch.time_step)));
}

// Frequency of the highest mean of the periodograms, each over the energy of its stretch, on a grid
// that all of them reach.   @param step  of the grid [Hz]
double highest(const std::vector<Stretch>& stretches, double longest, double least_frequency,
               double step) {
  double coarsest = 0;
  for (const auto& stretch : stretches) coarsest = std::max(coarsest, stretch.time_step);
  VectorXd sum = VectorXd::Zero(static_cast<Index>(0.5 / coarsest / step + kBinRoundOff));
  for (const auto& stretch : stretches) {
    const auto& [x, time_step] = stretch;
    VectorXd padded = VectorXd::Zero(length_for(longest, stretch));
    padded.head(x.size()) = x;
    const VectorXcd bins = maths::spectrum(padded);
    const double per_step = step * static_cast<double>(padded.size()) * time_step;  // 1 at one rate
    for (Index k = 0; k < sum.size(); ++k)
      sum[k] += std::norm(bins[std::llround(static_cast<double>(k) * per_step)]) /
                std::max(x.squaredNorm(), 1e-300);
  }
  const auto first =
      std::min(static_cast<Index>(std::ceil(least_frequency / step)), sum.size() - 1);
  Index at = 0;
  sum.tail(sum.size() - first).maxCoeff(&at);
  return static_cast<double>(first + at) * step;
}

}  // namespace

double remove_line(std::vector<Stretch>& stretches) {
  if (stretches.size() < kLeastStretches) return 0;
  const auto is_short = [](const Stretch& stretch) {
    return stretch.samples.size() < kLeastSamplesOfLine;
  };
  if (std::any_of(stretches.begin(), stretches.end(), is_short)) return 0;
  const auto [shortest, longest] = std::minmax_element(
      stretches.begin(), stretches.end(),
      [](const Stretch& a, const Stretch& b) { return duration_of(a) < duration_of(b); });
  const double duration = duration_of(*longest);
  const double step =
      1 / (static_cast<double>(length_for(duration, *longest)) * longest->time_step);
  const double near = highest(stretches, duration, kLeastCycles / duration_of(*shortest), step);
  double best = 0, frequency = 0;
  for (int k = -4; k <= 4; ++k) {
    const double tried = near + k / 8.0 * step;
    const double share = share_of(stretches, tried);
    if (share > best) best = share, frequency = tried;
  }
  if (best < kLeastLineShare) return 0;
  for (auto& stretch : stretches) stretch.samples = without_sine(stretch, frequency);
  return frequency;
}

}  // namespace rths::diagnosis
