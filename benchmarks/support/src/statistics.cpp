// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/statistics.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace rths::bench {
namespace {

constexpr int kResamples = 10'000;
constexpr double kOutside = 0.05;  // share outside a 95 % interval, both sides together

double quantile_of_sorted(const std::vector<double>& sorted, double fraction) {
  const double position = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

}  // namespace

double quantile(std::vector<double> values, double fraction) {
  std::sort(values.begin(), values.end());
  return quantile_of_sorted(values, fraction);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

Interval median_interval(const std::vector<double>& values, std::uint64_t seed) {
  // The standard defines the engine's numbers, but not those of distributions. The remainder
  // favours small indices by 1 in 2⁶⁰, which is negligible.
  std::mt19937_64 engine{seed};
  std::vector<double> medians(kResamples);
  std::vector<double> drawn(values.size());
  for (double& middle : medians) {
    for (double& value : drawn) value = values[engine() % values.size()];
    middle = median(drawn);
  }
  std::sort(medians.begin(), medians.end());
  return {quantile_of_sorted(medians, kOutside / 2), quantile_of_sorted(medians, 1 - kOutside / 2)};
}

Times times_of(std::vector<double> nanoseconds) {
  std::sort(nanoseconds.begin(), nanoseconds.end());
  return {quantile_of_sorted(nanoseconds, 0.5), quantile_of_sorted(nanoseconds, 0.99)};
}

Times median(const std::vector<Times>& times) {
  std::vector<double> p50, p99;
  for (const auto& one : times) {
    p50.push_back(one.p50);
    p99.push_back(one.p99);
  }
  return {median(std::move(p50)), median(std::move(p99))};
}

}  // namespace rths::bench
