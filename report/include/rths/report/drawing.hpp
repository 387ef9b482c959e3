// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::report {

/// A line through points.
struct Curve {
  std::string label;  ///< in the legend; empty: in none
  std::vector<double> x, y;
  bool is_reference = false;  ///< drawn thin and grey, behind the others
};

/// A pair of axes with curves.
struct Panel {
  std::string title, x_label, y_label;  ///< labels with units
  std::vector<Curve> curves;
};

/// Panels side by side, as a picture in SVG that needs nothing else. The same input gives the same
/// bytes. Points that lie on the line between their neighbours are left out.
/// @throws Error if a curve has no points, or as many x as y it has not   @setup
[[nodiscard]] std::string draw(const std::string& title, const std::vector<Panel>& panels);

}  // namespace rths::report
