// SPDX-License-Identifier: Apache-2.0
#include "joined.hpp"
#include "kinds.hpp"

#include "sensor_kinds.hpp"

namespace rths::sim {

// In the order of a signal's path: crosstalk, scaling, timing, range and resolution.
std::span<const TermKind> sensor_kinds() {
  static const auto kinds = joined(
      {sensor_cross_kinds(), sensor_scale_kinds(), sensor_time_kinds(), sensor_range_kinds()});
  return kinds;
}

}  // namespace rths::sim
