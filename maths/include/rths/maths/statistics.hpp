// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace rths::maths {

/// Half width of a two-sided 95 % interval over the standard deviation, normal distribution [-]: in
/// verdicts.
inline constexpr double kNormal95 = 1.96;
/// The same with more digits: of intervals of delays, gains and forces.
inline constexpr double kHalfWidth95 = 1.959964;

/// Mean, root mean square, and standard deviation about the mean; 0 without values.
[[nodiscard]] double mean(std::span<const double> values);
[[nodiscard]] double rms(std::span<const double> values);
[[nodiscard]] double deviation(std::span<const double> values);

[[nodiscard]] double largest_magnitude(std::span<const double> values);  ///< 0 without values

/// The value to this number of significant digits. Beyond 10^±22 it is returned as it is, because
/// those powers of ten are not exact.
[[nodiscard]] double rounded(double value, int digits);

/// The value with `rank` others before it in rising order.   @param rank  below the number of
/// values
template <class Value>
[[nodiscard]] Value of_rank(std::vector<Value> values, std::size_t rank) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The middle value; of an even number, the larger one of the middle two.
/// @param values  at least one
template <class Value>
[[nodiscard]] Value median(std::vector<Value> values) {
  const std::size_t rank = values.size() / 2;
  return of_rank(std::move(values), rank);
}

/// The value of rank share (n − 1), rounded down; 0 without values. A share of a half is the middle
/// value, of an even number the smaller one of the middle two.
/// @param share  0 to 1 [-]
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// Differences of neighbouring values.
[[nodiscard]] std::vector<double> steps_of(std::span<const double> values);

}  // namespace rths::maths
