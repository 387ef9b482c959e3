// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/memmap/map.hpp>

namespace rths::memmap {

/// Every rule a memory map must keep. Partitions and signals come in order of offset.
/// @throws Error with the place of the first word that breaks one
void check_rules(const MapDescription& description);

}  // namespace rths::memmap
