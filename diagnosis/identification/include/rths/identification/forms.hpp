// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// Form of an unknown effect: the mean residual over the variable that it depends on.
struct Description {
  std::string form;     ///< "f(u)", "sgn(v) g(u)", "external periodic force"
  double share = 0;     ///< of the energy beyond the noise, explained on another record [-]
  std::string x_label;  ///< variable of the curve, with its unit
  std::vector<double> x, y, band;  ///< curve [unit of the output] and its standard deviation
};

/// Describes the form of a residual that no term explains: curves and surfaces over recorded
/// quantities, a line in the spectrum, a sudden change. Each form is fitted to one fold and ranked
/// by the share of the other fold's energy beyond the noise that it explains; best first.
[[nodiscard]] std::vector<Description> describe(const Supposition& supposition, const Folds& folds);

}  // namespace rths::diagnosis
