// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rths::broker {

/// A process in 64 bits: its id and when it started, so that a reused id is another process.
/// 0 is nobody.
using Claim = std::uint64_t;

[[nodiscard]] Claim own_claim();
/// The kernel's word on whether that process still runs; never a time-out.
[[nodiscard]] bool is_alive(Claim claim);
[[nodiscard]] constexpr int pid_of(Claim claim) noexcept {
  return static_cast<int>(claim & 0xFFFF'FFFF);
}

}  // namespace rths::broker
