// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/sim/lead_rubber_design.hpp>

#include "opensees_run.hpp"

namespace rths::sim::test {

/// One line of the comparison.
struct OpenseesRow {
  std::string name;  ///< letters and digits
  TwoBearings bearing;
  double amplitude = 0.2;   ///< of the paths [m]
  double time_step = 5e-4;  ///< [s]
  double bound = 0.005;     ///< on the NRMSE of shear and axial force, on every path
  /// Is led along a path, too, whose load swings up to so many times its mean in tension and
  /// compression; 0: is not.
  double swing = 0;
  /// Why the two are meant to differ; empty: they state the same law.
  std::string deviation = {};
};

/// The lead-rubber bearing of the rows.
[[nodiscard]] LeadRubberDesign compared_design();
/// That with heating alone.
[[nodiscard]] TwoBearings heated_bearing();

[[nodiscard]] std::vector<OpenseesRow> elastomeric_rows();
[[nodiscard]] std::vector<OpenseesRow> sliding_rows();

}  // namespace rths::sim::test
