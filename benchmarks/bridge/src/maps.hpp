// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <rths/memmap/map.hpp>

namespace rths::bench {

inline constexpr std::uint32_t kJournalBits = 20;
inline constexpr LongwordOffset kNearWord{0}, kFarWord{1024};
inline constexpr std::uint32_t kStepWords = 100;            ///< of a step of the row `load`
inline constexpr std::uint32_t kImageLongwords = 1U << 21;  ///< 8 MiB

/// Nodes `near` and `far` with a partition each.
[[nodiscard]] memmap::Map small_map();
/// A ring of 8 MiB whose words all belong to the node `near`.
[[nodiscard]] memmap::Map image_map();

}  // namespace rths::bench
