// SPDX-License-Identifier: Apache-2.0
//
// Waking those who sleep until somebody writes. A writer pays one load of a line that nobody
// touches while nobody sleeps; the fence that this needs is on the sleeper's side.
#pragma once

#include <atomic>
#include <cstdint>

#include <rths/core/clock.hpp>

namespace rths::broker {

/// Shared by all processes of a ring: two lines, so that sleepers do not disturb each other's word.
struct alignas(64) Wake {
  std::uint32_t calls = 0;                 ///< futex word: counts wake-ups
  alignas(64) std::uint32_t sleepers = 0;  ///< slots that sleep, or are about to, a bit each
};
static_assert(sizeof(Wake) == 128);

/// Makes this process's writes visible to the fence of other processes' sleepers. Once, before the
/// first write.
void register_as_writer();

/// The slow part of `wake_sleepers`.
void wake_all(Wake& wake) noexcept;

/// After a write.
inline void wake_sleepers(Wake& wake) noexcept {
  if (std::atomic_ref{wake.sleepers}.load(std::memory_order_relaxed) != 0) wake_all(wake);
}

/// Says, for as long as it lives, that a slot is about to sleep: from its construction on, every
/// write that a look afterwards does not show will wake it.
class Drowsy {
 public:
  Drowsy(Wake& wake, std::uint32_t slot) noexcept;
  ~Drowsy();
  Drowsy(const Drowsy&) = delete;
  Drowsy& operator=(const Drowsy&) = delete;

  /// Sleeps until somebody writes, `most` has passed, or for no reason.
  void sleep(Duration most) noexcept;

 private:
  Wake& wake_;
  std::uint32_t bit_;
  std::uint32_t calls_;
};

}  // namespace rths::broker
