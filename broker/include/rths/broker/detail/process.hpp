// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace rths::broker {

/// A process of this host as 64 bits: 20 random bits, its PID namespace, its id there. The random
/// bits distinguish it from earlier processes of this id. 0: none.
using Claim = std::uint64_t;

/// Claim of this process; a forked child has another one than its parent.   @setup
[[nodiscard]] Claim own_claim();
/// The process's id in its own PID namespace.
[[nodiscard]] constexpr int pid_of(Claim claim) noexcept {
  return static_cast<int>(claim & 0x3F'FFFF);
}
/// False for a process of another PID namespace: its id may be that of another process here, so it
/// cannot be signalled.
[[nodiscard]] bool is_of_this_namespace(Claim claim);
/// "process 7", or "process 7 of PID namespace 4026532567 (here: 4026531836)".
[[nodiscard]] std::string in_words(Claim claim);

/// Shows this process to all processes that use an object, in whatever namespace: until this is
/// destroyed or the process ends, the kernel holds a lock on the byte of its claim, beyond the
/// object's content. The lock belongs to a mapping, which a forked child does not inherit and a
/// program that closes all descriptors does not lose.
class Membership {
 public:
  /// @param object  descriptor of the object
  /// @throws Error if another process is removing the object, or the system refuses the lock @setup
  explicit Membership(int object);
  ~Membership();
  Membership(const Membership&) = delete;
  Membership& operator=(const Membership&) = delete;

 private:
  void* page_;
  Claim self_;
};

/// The processes that are on an object, by their locks.
class Members {
 public:
  /// @param object  its descriptor, which must stay open; -1: an object without processes
  explicit Members(int object) : object_{object} {}
  /// True if the process runs and is on the object; uses no time-out. One system call.
  [[nodiscard]] bool has(Claim claim) const noexcept;
  /// Keeps all processes off the object until its descriptor is closed. @returns false if there is
  /// a process on it, or another one keeps them off
  [[nodiscard]] bool exclude() const noexcept;

 private:
  int object_;
};

}  // namespace rths::broker
