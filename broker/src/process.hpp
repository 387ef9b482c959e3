// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rths::broker {

/// A process as 64 bits: its id and its start time, which distinguishes a reused id. 0: none.
using Claim = std::uint64_t;

[[nodiscard]] Claim own_claim();
/// True if the process still runs, from the kernel's process table; uses no time-out.
[[nodiscard]] bool is_alive(Claim claim);
[[nodiscard]] constexpr int pid_of(Claim claim) noexcept {
  return static_cast<int>(claim & 0xFFFF'FFFF);
}

}  // namespace rths::broker
