// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/memmap/map.hpp>

namespace rths::memmap {

/// Checks all rules of a memory map. Expects partitions and signals in order of offset.
/// @throws Error "file:line:column: …" for the first rule that is broken
void check_rules(const MapDescription& description);

}  // namespace rths::memmap
