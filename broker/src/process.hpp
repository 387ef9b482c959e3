// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>

namespace rths::broker {

/// A process as 64 bits: its id and its start time, which distinguishes a reused id. 0: none.
using Claim = std::uint64_t;

/// A shared-memory object and its permissions.
struct ObjectId {
  dev_t device;
  ino_t inode;
  uid_t owner;
  mode_t mode;
};

/// Claim of a process; 0 if it has ended.
[[nodiscard]] Claim claim_of(int pid);
[[nodiscard]] Claim own_claim();
/// True if the process still runs, from the kernel's process table; uses no time-out.
[[nodiscard]] bool is_alive(Claim claim);
/// True if the process runs and has mapped the object. If this user may not see its mappings: if
/// its user may write to the object.
[[nodiscard]] bool is_on(Claim claim, const ObjectId& object);
[[nodiscard]] constexpr int pid_of(Claim claim) noexcept {
  return static_cast<int>(claim & 0xFFFF'FFFF);
}

}  // namespace rths::broker
