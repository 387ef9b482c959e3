// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include <rths/sim/composition.hpp>

namespace rths::diagnosis {

/// A symbol of a unit and its power.
struct UnitFactor {
  std::string_view symbol;  ///< "m", "N", "1"
  int power;                ///< negative behind the first stroke: in "W/m/K" both m and K divide
};
[[nodiscard]] std::vector<UnitFactor> factors_of(std::string_view unit);

/// Units in which a component of a model computes, as multiples of m, N and s. The catalogue's
/// bounds are those of a laboratory's machines; a circuit of millivolts or a tank of hours keeps
/// within them if it counts in units of its own.
struct UnitScales {
  double length = 1, force = 1, time = 1;

  /// Of a parameter's unit, "N*s/m3": SI value over this is the value that terms compute with.
  /// @throws Error if the unit has a symbol that is not known   @setup
  [[nodiscard]] double of(std::string_view unit) const;
};

/// A power of ten that brings `size` near `typical`, or 1 if it lies within [low, high] as it is.
[[nodiscard]] double scale_for(double size, double low, double high, double typical);

/// The same term as it computes in these units, with every parameter stated.
/// @throws Error for an unknown kind or parameter   @setup
[[nodiscard]] sim::TermSettings in_units(const sim::TermSettings& term, const UnitScales& scales);

}  // namespace rths::diagnosis
