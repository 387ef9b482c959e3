// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/memmap/map.hpp>

#include "support/files.hpp"

namespace rths::memmap {

/// The SRMD's map.
[[nodiscard]] inline Map srmd() {
  return load_map(test::source_tree() / "memmap/maps/srmd.ringmap.toml");
}

}  // namespace rths::memmap
