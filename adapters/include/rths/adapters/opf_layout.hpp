// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <rths/memmap/map.hpp>

namespace rths::adapters {

/// Physical quantity of a word of OpenFresco's block.
enum class OpfQuantity { Displacement, Velocity, Acceleration, Force, Time };

[[nodiscard]] const char* to_text(OpfQuantity quantity) noexcept;

/// One word of OpenFresco's block.
struct OpfSignal {
  std::string name;  ///< full: "opf.long.displ.target"
  std::string axis;  ///< "long"; "1" for a single axis and for times, which are numbered
  OpfQuantity quantity = OpfQuantity::Displacement;
  std::string unit;     ///< SI
  double map_unit = 1;  ///< the map's [SI]
  /// Values that its word can hold, within the range of the map [SI].
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
};

/// The block that OpenFresco and a controller share in a laboratory's map: newTarget, commands,
/// switchPC, atTarget, feedbacks. Both sides locate words by counting, so the block has no gaps.
struct OpfLayout {
  std::vector<OpfSignal> commands, feedbacks;  ///< in the order of their words

  /// Returns the word of an axis and quantity, or nullptr.
  [[nodiscard]] static const OpfSignal* find(const std::vector<OpfSignal>& signals,
                                             const std::string& axis, OpfQuantity quantity);
};

/// Reads the block from a map's partitions `opf` and `daq`.
/// @throws Error if the block is missing or its words are not in OpenFresco's order   @setup
[[nodiscard]] OpfLayout opf_layout(const memmap::Map& map);

}  // namespace rths::adapters
