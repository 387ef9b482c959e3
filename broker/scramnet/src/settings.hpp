// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace rths::scramnet {

inline constexpr const char* kGtVariables = "RTHS_SCGT_";

/// Ring and card of a process. The environment has precedence over the file of
/// RTHS_SCRAMNET_CONFIG, which has precedence over these defaults.
struct Settings {
  std::string ring = "scramnet";
  std::string map;                       ///< map file for a new ring; empty: memory without a map
  std::string node;                      ///< name in the map, or number; empty: a card of its own
  std::uint64_t ring_bytes = 2U << 20U;  ///< size of a new ring without a map [B]
  std::uint64_t card_bytes = 0;          ///< size of the card's window of the ring [B]; 0: all
  bool bypass_switch = true;             ///< whether CSR1 reports a fibre bypass switch
  bool share = false;           ///< whether to store into the words of a node that is running
  bool traps = true;            ///< whether to trap stores through a pointer, on a replicated ring
  bool ring_is_chosen = false;  ///< the ring's name is not the default
  std::string variables = "RTHS_SCRAMNET_";  ///< begin of the names of the environment variables
};

/// @throws Error "file:line:column: …" or with the name of the variable
[[nodiscard]] Settings plus_settings();
[[nodiscard]] Settings gt_settings(std::uint32_t unit);

/// Overrides RTHS_SCRAMNET_CONFIG.
void set_config_file(const char* file);

}  // namespace rths::scramnet
