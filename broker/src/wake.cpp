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

/// @returns the number of processes woken
long wake_up(Wake& wake) noexcept {
  std::atomic_ref{wake.calls}.fetch_add(1);
  return futex(wake.calls, FUTEX_WAKE, INT_MAX, nullptr);
}

}  // namespace

void register_as_writer() {
  static_cast<void>(membarrier(MEMBARRIER_CMD_REGISTER_GLOBAL_EXPEDITED));
}

// If no process woke, the bits are those of processes that died while they slept. A bit may also
// belong to a process that is just about to sleep again: the second wake-up keeps it awake.
void wake_all(Wake& wake) noexcept {
  const std::uint32_t seen = std::atomic_ref{wake.sleepers}.load(std::memory_order_relaxed);
  if (wake_up(wake) != 0) return;
  std::atomic_ref{wake.sleepers}.fetch_and(~seen);
  wake_up(wake);
}

Sleeper::Sleeper(Wake& wake, std::uint32_t slot) noexcept
    : wake_{wake}, bit_{1U << slot}, calls_{std::atomic_ref{wake.calls}.load()} {
  std::atomic_ref{wake_.sleepers}.fetch_or(bit_);
  // Makes every processor execute a fence: earlier writes are visible, later writers see the bit.
  // Without kernel support a wake-up may be missed.
  static_cast<void>(membarrier(MEMBARRIER_CMD_GLOBAL_EXPEDITED));
}

Sleeper::~Sleeper() { std::atomic_ref{wake_.sleepers}.fetch_and(~bit_); }

void Sleeper::sleep(Duration most) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const timespec timeout{most.count() / kSecond, most.count() % kSecond};
  futex(wake_.calls, FUTEX_WAIT, calls_, &timeout);
}

}  // namespace rths::broker
