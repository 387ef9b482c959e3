// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace rths::app {

/// Values times a factor, to change the unit for a drawing.
inline std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

}  // namespace rths::app
