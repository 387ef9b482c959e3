// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace rths::report {

/// Significant digits of the numbers in files.
inline constexpr int kDigits = 8;

/// Significant digits of instants that are a few `resolution` apart. Times since 1970 need many.
/// @param largest  instant [s]   @param usual  digits, at least
inline int digits_of_instants(double largest, double resolution, int usual) {
  constexpr int kBeyond = 2, kMost = 17;
  const double ratio = std::abs(largest) / resolution;
  if (!(ratio > 1) || !std::isfinite(ratio)) return usual;
  return std::clamp(static_cast<int>(std::ceil(std::log10(ratio))) + kBeyond, usual, kMost);
}

}  // namespace rths::report
