// SPDX-License-Identifier: Apache-2.0
#include "wake.hpp"

#include <linux/futex.h>
#include <linux/membarrier.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <climits>
#include <ctime>

namespace rths::broker {
namespace {

long membarrier(int command) noexcept {
  return syscall(SYS_membarrier, command, 0U, 0);  // NOLINT(cppcoreguidelines-pro-type-vararg)
}

long futex(std::uint32_t& word, int operation, std::uint32_t value,
           const timespec* timeout) noexcept {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
  return syscall(SYS_futex, &word, operation, value, timeout, nullptr, 0);
}

/// @returns how many it woke
long call(Wake& wake) noexcept {
  std::atomic_ref{wake.calls}.fetch_add(1);
  return futex(wake.calls, FUTEX_WAKE, INT_MAX, nullptr);
}

}  // namespace

void register_as_writer() {
  static_cast<void>(membarrier(MEMBARRIER_CMD_REGISTER_GLOBAL_EXPEDITED));
}

// A bit that nobody is behind is that of a process that died in its sleep. It may also be that of
// one that is only just lying down, for the second time already: then the second call keeps it up.
void wake_all(Wake& wake) noexcept {
  const std::uint32_t seen = std::atomic_ref{wake.sleepers}.load(std::memory_order_relaxed);
  if (call(wake) != 0) return;
  std::atomic_ref{wake.sleepers}.fetch_and(~seen);
  call(wake);
}

Drowsy::Drowsy(Wake& wake, std::uint32_t slot) noexcept
    : wake_{wake}, bit_{1U << slot}, calls_{std::atomic_ref{wake.calls}.load()} {
  std::atomic_ref{wake_.sleepers}.fetch_or(bit_);
  // Every processor passes a fence here: whoever wrote before has made it visible, whoever writes
  // after sees the bit. A kernel that has no such thing may let one oversleep.
  static_cast<void>(membarrier(MEMBARRIER_CMD_GLOBAL_EXPEDITED));
}

Drowsy::~Drowsy() { std::atomic_ref{wake_.sleepers}.fetch_and(~bit_); }

void Drowsy::sleep(Duration most) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const timespec timeout{most.count() / kSecond, most.count() % kSecond};
  futex(wake_.calls, FUTEX_WAIT, calls_, &timeout);
}

}  // namespace rths::broker
