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

/// @param bits  a sleeper with any of the bits is woken
long futex(std::uint32_t& word, int operation, std::uint32_t value, const timespec* timeout,
           std::uint32_t bits) noexcept {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
  return syscall(SYS_futex, &word, operation, value, timeout, nullptr, bits);
}

/// @returns the number of processes woken
long wake_up(Wake& wake, std::uint32_t bits) noexcept {
  std::atomic_ref{wake.calls}.fetch_add(1);
  return futex(wake.calls, FUTEX_WAKE_BITSET, INT_MAX, nullptr, bits);
}

}  // namespace

void register_as_writer() {
  static_cast<void>(membarrier(MEMBARRIER_CMD_REGISTER_GLOBAL_EXPEDITED));
}

// If no process woke, the bits are those of processes that died while they slept. A bit may also
// belong to a process that is just about to sleep again: the second wake-up keeps it awake.
void wake_all(Wake& wake, std::uint32_t spared) noexcept {
  const std::uint32_t seen =
      std::atomic_ref{wake.sleepers}.load(std::memory_order_relaxed) & ~spared;
  if (seen == 0 || wake_up(wake, ~spared) != 0) return;
  std::atomic_ref{wake.sleepers}.fetch_and(~seen);
  wake_up(wake, ~spared);
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
  const auto until = (WallClock{}.now() + most).count();
  const timespec timeout{until / kSecond, until % kSecond};
  futex(wake_.calls, FUTEX_WAIT_BITSET, calls_, &timeout, bit_);
}

}  // namespace rths::broker
