// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "opensees_run.hpp"

namespace rths::sim::test {

/// One line of the comparison.
struct OpenseesRow {
  std::string name;  ///< letters and digits
  TwoBearings bearing;
  double amplitude = 0.2;   ///< of the paths [m]
  double time_step = 5e-4;  ///< [s]
  double bound = 0.005;     ///< on the NRMSE of shear and axial force, on every path
  bool pulled = false;      ///< is led along a path with tension, too
  /// Why the two are meant to differ; empty: they state the same law.
  std::string deviation = {};
};

[[nodiscard]] std::vector<OpenseesRow> elastomeric_rows();
[[nodiscard]] std::vector<OpenseesRow> sliding_rows();

}  // namespace rths::sim::test
