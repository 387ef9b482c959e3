// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::app {

/// A curve through points.
struct Curve {
  std::string label;  ///< in the legend; empty: not listed
  std::vector<double> x, y;
  bool is_reference = false;  ///< drawn thin and grey, behind the others
};

/// A pair of axes with curves.
struct Panel {
  std::string title, x_label, y_label;  ///< labels with units
  std::vector<Curve> curves;
};

/// Draws panels side by side as a self-contained SVG picture. The same input gives the same bytes.
/// Points on the straight line between their neighbours are left out.
/// @throws Error if a curve has no points, or different numbers of x and y   @setup
[[nodiscard]] std::string draw(const std::string& title, const std::vector<Panel>& panels);

/// Values times a factor, to change the unit for a drawing.
inline std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

}  // namespace rths::app
