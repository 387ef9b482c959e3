// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/memmap/map.hpp>

namespace rths::adapters {

/// What a word of OpenFresco's block tells of an axis.
enum class Quantity { Displacement, Velocity, Acceleration, Force, Time };

[[nodiscard]] const char* to_text(Quantity quantity) noexcept;

/// One word of OpenFresco's block.
struct OpfSignal {
  std::string name;  ///< full: "opf.long.displ.target"
  std::string axis;  ///< "long"; "1" where there is only one, and for times: they are counted
  Quantity quantity = Quantity::Displacement;
  std::string unit;     ///< SI
  double map_unit = 1;  ///< the map's [SI]
};

/// The block that OpenFresco and a controller share in a laboratory's map: newTarget, commands,
/// switchPC, atTarget, feedbacks. Both sides count words, so neither may leave one out.
struct OpfLayout {
  std::vector<OpfSignal> commands, feedbacks;  ///< in the order of their words

  /// The word of an axis and quantity, or nothing.
  [[nodiscard]] static const OpfSignal* find(const std::vector<OpfSignal>& signals,
                                             const std::string& axis, Quantity quantity);
};

/// Reads the block out of a map: partitions `opf` and `daq`.
/// @throws Error if the map has none, or one whose words are not in OpenFresco's order   @setup
[[nodiscard]] OpfLayout opf_layout(const memmap::Map& map);

}  // namespace rths::adapters
