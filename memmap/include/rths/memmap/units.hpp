// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::memmap {

/// Conversion of a unit to the coherent SI unit of its quantity:  si = scale·value + offset.
struct Unit {
  std::string si;     ///< name of the SI unit: "m", "N", "m/s2", …; "1" for pure numbers
  double scale = 1;   ///< [SI unit per unit]
  double offset = 0;  ///< [SI unit]
};

/// Reads a unit as UDUNITS spells it: "mm", "kN", "gravity", "kN.s/m", "1".
/// @throws Error, without a file position, if the unit does not parse, if its quantity is not
///         supported, or if it is "g": UDUNITS reads a gram, users mean an acceleration.   @setup
[[nodiscard]] Unit parse_unit(const std::string& text);

}  // namespace rths::memmap
