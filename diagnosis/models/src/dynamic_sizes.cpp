// SPDX-License-Identifier: Apache-2.0
#include "dynamic_sizes.hpp"

#include <algorithm>
#include <cmath>

namespace rths::diagnosis {

// A scale is 1 if the size is within the catalogue's bounds, so that users see SI values.
double DynamicSizes::time_scale() const { return scale_for(time_step, 1e-4, 1e-2, 1e-3); }

UnitScales DynamicSizes::of_signal(const SignalSize& size) const {
  const double unit = scale_for(size.peak, 1e-3, 0.1, 0.03);
  return {unit, unit, time_scale()};
}

UnitScales DynamicSizes::of_connection(const ConnectionSize& size) const {
  return {scale_for(size.displacement, 1e-3, 0.3, 0.03), scale_for(size.force, 1e-2, 1e6, 1e4),
          time_scale()};
}

void enlarge(SignalSize& size, const std::vector<double>& signal, double time_step) {
  double sum = 0, before = signal.empty() ? 0 : signal.front();
  for (const double value : signal) {
    size.peak = std::max(size.peak, std::abs(value));
    size.rate = std::max(size.rate, std::abs(value - before) / time_step);
    sum += value * value;
    before = value;
  }
  if (!signal.empty())
    size.rms = std::max(size.rms, std::sqrt(sum / static_cast<double>(signal.size())));
}

}  // namespace rths::diagnosis
