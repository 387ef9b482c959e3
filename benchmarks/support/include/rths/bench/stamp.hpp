// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#if defined(__x86_64__)
#include <x86intrin.h>
#else
#include <chrono>
#endif

namespace rths::bench {

/// The time in ticks of the cheapest clock: reading it takes 10 ns on x86; the system's clock takes
/// 22 ns.
[[nodiscard]] inline std::uint64_t stamp() noexcept {
#if defined(__x86_64__)
  return __rdtsc();
#else
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
}

/// The same, after all earlier instructions and before all later ones. Stores may still be in the
/// store buffer.
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

/// Pause instruction of a waiting loop: the processor polls the cache line less often.
inline void pause() noexcept {
#if defined(__x86_64__)
  _mm_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Period of a tick of `stamp`, measured by the system's clock [ns].   @setup
[[nodiscard]] double measure_tick();

}  // namespace rths::bench
