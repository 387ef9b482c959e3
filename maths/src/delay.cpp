// SPDX-License-Identifier: Apache-2.0
#include <rths/maths/delay.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::maths {
namespace {

struct Overlap {
  std::span<const double> reference, measured;
};

// The overlapping ranges when the measured signal is moved `shift` samples earlier.
Overlap overlap(std::span<const double> reference, std::span<const double> measured, long shift) {
  const auto moved = static_cast<std::size_t>(std::abs(shift));
  const std::size_t length = reference.size() - moved;
  return shift >= 0 ? Overlap{reference.subspan(0, length), measured.subspan(moved, length)}
                    : Overlap{reference.subspan(moved, length), measured.subspan(0, length)};
}

double correlation(const Overlap& o) {
  const auto n = static_cast<double>(o.reference.size());
  double sum_r = 0, sum_m = 0, rr = 0, mm = 0, rm = 0;
  for (std::size_t i = 0; i < o.reference.size(); ++i) {
    const double r = o.reference[i];
    const double m = o.measured[i];
    sum_r += r;
    sum_m += m;
    rr += r * r;
    mm += m * m;
    rm += r * m;
  }
  return (rm - sum_r * sum_m / n) / std::sqrt((rr - sum_r * sum_r / n) * (mm - sum_m * sum_m / n));
}

double mean_square_difference(const Overlap& o) {
  double sum = 0;
  for (std::size_t i = 0; i < o.reference.size(); ++i) {
    const double difference = o.measured[i] - o.reference[i];
    sum += difference * difference;
  }
  return sum / static_cast<double>(o.reference.size());
}

// Vertex of the parabola through three neighbours, in samples from the middle one.
double vertex(double before, double at, double after) {
  const double bend = before - 2 * at + after;
  return bend == 0 ? 0 : std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
}

// Shift with the largest score, refined between samples except at the ends of the search.
double best_shift(const std::vector<double>& scores, long search) {
  const auto best = std::max_element(scores.begin(), scores.end());
  const auto index = best - scores.begin();
  const double whole = static_cast<double>(index - search);
  if (best == scores.begin() || best == scores.end() - 1) return whole;
  return whole + vertex(*(best - 1), *best, *(best + 1));
}

}  // namespace

DelayIdentification identify_delay(std::span<const double> reference,
                                   std::span<const double> measured, double time_step,
                                   double search) {
  const long shifts = std::lround(search / time_step);
  if (reference.size() != measured.size())
    throw Error{fmt::format("delay: the signals have {} and {} values, expected equal lengths",
                            reference.size(), measured.size())};
  if (shifts < 1 || reference.size() < static_cast<std::size_t>(4 * shifts))
    throw Error{fmt::format(
        "delay: the signals have {} values, expected at least four times the largest shift, {}",
        reference.size(), 4 * shifts)};
  std::vector<double> correlations;
  std::vector<double> closeness;
  for (long shift = -shifts; shift <= shifts; ++shift) {
    const Overlap o = overlap(reference, measured, shift);
    correlations.push_back(correlation(o));
    closeness.push_back(-mean_square_difference(o));
  }
  if (std::any_of(correlations.begin(), correlations.end(),
                  [](double c) { return !std::isfinite(c); }))
    throw Error{"delay: a signal is constant"};
  return {best_shift(correlations, shifts) * time_step, best_shift(closeness, shifts) * time_step};
}

TrackingError tracking_error(std::span<const double> reference, std::span<const double> measured) {
  if (reference.size() != measured.size())
    throw Error{
        fmt::format("tracking error: the signals have {} and {} values, expected equal lengths",
                    reference.size(), measured.size())};
  const double largest = largest_magnitude(reference);
  if (!(largest > 0)) throw Error{"tracking error: the reference is zero throughout"};
  double peak = 0;
  for (std::size_t i = 0; i < reference.size(); ++i)
    peak = std::max(peak, std::abs(measured[i] - reference[i]));
  const double rms = std::sqrt(mean_square_difference({reference, measured}));
  return {rms, rms / largest, peak / largest};
}

}  // namespace rths::maths
