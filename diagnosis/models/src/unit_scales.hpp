// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <rths/sim/composition.hpp>

namespace rths::diagnosis {

/// A symbol of a unit and its power.
struct UnitFactor {
  std::string_view symbol;  ///< "m", "N", "1"
  int power;                ///< negative after the first slash: in "W/m/K" both m and K divide
};
[[nodiscard]] std::vector<UnitFactor> factors_of(std::string_view unit);

/// A unit of the catalogue with other symbols for length, force and current: those of the channels
/// on which a term acts. "N*s/m" of a force in Pa is "Pa*s/m".
struct UnitSymbols {
  std::string length = "m", force = "N", current = "A";
  [[nodiscard]] std::string of(std::string_view unit) const;
};

/// Units of the computation in a component of a model, as multiples of m, N and s. The catalogue's
/// bounds suit a laboratory's machines. A circuit of millivolts or a tank of hours stays within
/// them after scaling.
struct UnitScales {
  double length = 1, force = 1, time = 1;
  /// Of a sensor term's channel; none: as of a force.
  std::optional<double> channel = {};  // NOLINT: designated initializers need it
  double current = 1;

  /// Scale of a parameter's unit, "N*s/m3": the SI value divided by it is the value in these units.
  /// @throws Error if the unit has an unknown symbol   @setup
  [[nodiscard]] double of(std::string_view unit) const;
};

/// A power of ten that brings `size` near `typical`, or 1 if it lies within [low, high].
[[nodiscard]] double scale_for(double size, double low, double high, double typical);

/// The same term in these units, with every parameter stated.
/// @throws Error for an unknown kind or parameter   @setup
[[nodiscard]] sim::TermSettings in_units(const sim::TermSettings& term, const UnitScales& scales);

}  // namespace rths::diagnosis
