// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/memmap/map.hpp>

namespace rths::recording {

/// A planned fault of the writes of a node.
struct MessageFault {
  double at = 0;                  ///< begin [s]
  std::string kind;               ///< "drop", "delay", "flip"
  std::string node;               ///< that writes
  std::string signal;             ///< of drop and flip; empty: all of the node
  std::optional<double> lasting;  ///< empty: until the end [s]
  double delay = 0;               ///< [s]
  int bit = 0;                    ///< of flip; 0 is the lowest
};

/// Reads a fault: kind, node or signal, at_s, for_s, delay_s, bit.
/// @param others  kinds beside those of messages, of the whole program of a node
/// @throws Error with the place of the first mistake   @setup
[[nodiscard]] MessageFault read_message_fault(const Config& table, const memmap::Map& map,
                                              const std::vector<std::string>& others = {});

}  // namespace rths::recording
