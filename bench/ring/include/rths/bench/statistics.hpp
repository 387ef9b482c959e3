// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace rths::bench {

/// The value below which a part of the values lies, linear between neighbours.
/// @param values  at least one, in any order
/// @param part    0 to 1 [-]
[[nodiscard]] double quantile(std::vector<double> values, double part);
[[nodiscard]] double median(std::vector<double> values);

struct Interval {
  double low = 0, high = 0;
};

/// Where the median would lie in 95 of 100 repetitions, by resampling the values themselves
/// (percentile bootstrap). The same seed gives the same interval on every machine.
/// @param values  at least one
[[nodiscard]] Interval median_interval(const std::vector<double>& values, std::uint64_t seed);

/// One-way time of a message, or time of a write: the middle and the tail of many.
struct Times {
  double p50 = 0, p99 = 0;  ///< [ns]
};

[[nodiscard]] Times times_of(std::vector<double> nanoseconds);

}  // namespace rths::bench
