// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace rths::bench {

/// Quantile of the values, interpolated linearly.
/// @param values    at least one, in any order
/// @param fraction  of the values below the quantile, 0 to 1 [-]
[[nodiscard]] double quantile(std::vector<double> values, double fraction);
[[nodiscard]] double median(std::vector<double> values);

struct Interval {
  double low = 0, high = 0;
};

/// 95 % interval of the median, by resampling the values (percentile bootstrap). The same seed
/// gives the same interval on every machine.
/// @param values  at least one
[[nodiscard]] Interval median_interval(const std::vector<double>& values, std::uint64_t seed);

/// Median and 99 % quantile of many one-way times or write times.
struct Times {
  double p50 = 0, p99 = 0;  ///< [ns]
};

[[nodiscard]] Times times_of(std::vector<double> nanoseconds);

/// Median of each of both. @param times  at least one
[[nodiscard]] Times median(const std::vector<Times>& times);

}  // namespace rths::bench
