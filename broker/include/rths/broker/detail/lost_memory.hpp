// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace rths::broker {

/// Handles lost pages of a mapping; see `on_lost_memory`. Sets `lost` when a page is lost.
void guard(std::byte* address, std::uint64_t bytes, std::atomic<bool>& lost) noexcept;
void unguard(std::byte* address) noexcept;

}  // namespace rths::broker
