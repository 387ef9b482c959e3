// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/sim/lead_rubber_design.hpp>

#include "opensees_run.hpp"

namespace rths::sim::test_support {

/// One row of the comparison.
struct OpenSeesRow {
  std::string name;  ///< letters and digits
  TwoBearings bearing;
  double amplitude = 0.2;   ///< of the paths [m]
  double time_step = 5e-4;  ///< [s]
  double bound = 0.005;     ///< on the NRMSE of shear and axial force, on every path
  /// Adds a path whose load alternates up to this multiple of its mean in tension and compression;
  /// 0: none.
  double swing = 0;
  /// Reason of an intended difference; empty: both implement the same law.
  std::string deviation = {};
};

/// Appends the elements of an array.
void append(nlohmann::json& to, const nlohmann::json& more);

/// The lead-rubber bearing of the rows.
[[nodiscard]] LeadRubberDesign compared_design();
/// The same bearing with heating as its only effect.
[[nodiscard]] TwoBearings heated_bearing();

[[nodiscard]] std::vector<OpenSeesRow> elastomeric_rows();
[[nodiscard]] std::vector<OpenSeesRow> sliding_rows();

}  // namespace rths::sim::test_support
