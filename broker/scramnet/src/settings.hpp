// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace rths::scramnet {

/// Which card a process holds, on which ring. From the environment, before that from the file that
/// RTHS_SCRAMNET_CONFIG names, before that these defaults.
struct Settings {
  std::string ring = "scramnet";
  std::string map;   ///< file of the map that the ring is made from; without one, only memory
  std::string node;  ///< its name in the map, or its number; without one, a card of its own
  std::uint64_t ring_bytes = 2U << 20U;  ///< of a ring that has to be made without a map
  std::uint64_t card_bytes = 0;          ///< what the card shows of the ring; 0 for all of it
  bool bypass_switch = true;             ///< what CSR1 says of the fibre's bypass switch
};

/// @throws Error with file:line:column, or with the name of the variable
[[nodiscard]] Settings plus_settings();
[[nodiscard]] Settings gt_settings(std::uint32_t unit);

/// Takes the place of RTHS_SCRAMNET_CONFIG.
void set_config_file(const char* file);

}  // namespace rths::scramnet
