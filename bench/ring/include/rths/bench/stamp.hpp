// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#if defined(__x86_64__)
#include <x86intrin.h>
#else
#include <chrono>
#endif

namespace rths::bench {

/// A point in time, in ticks of the cheapest clock there is: 10 ns to read on x86, where the
/// system's clock takes 22 ns.
[[nodiscard]] inline std::uint64_t stamp() noexcept {
#if defined(__x86_64__)
  return __rdtsc();
#else
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
}

/// The same, once everything before it has been executed, and before anything behind it is. Stores
/// may still be on their way.
[[nodiscard]] inline std::uint64_t stamp_between() noexcept {
#if defined(__x86_64__)
  unsigned processor = 0;
  const std::uint64_t now = __rdtscp(&processor);
  _mm_lfence();
  return now;
#else
  return stamp();
#endif
}

/// Tells the processor that this loop waits, so that it leaves the line it looks at alone.
inline void pause() noexcept {
#if defined(__x86_64__)
  _mm_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Length of a tick of `stamp`, held against the system's clock [ns].   @setup
[[nodiscard]] double measure_tick();

}  // namespace rths::bench
