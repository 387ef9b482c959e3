// SPDX-License-Identifier: Apache-2.0
//
// Sleeping until somebody writes. The fence that this needs is on the sleeper's side; the writer's
// is in detail/wake.hpp.
#pragma once

#include <cstdint>

#include <rths/broker/detail/wake.hpp>
#include <rths/core/clock.hpp>

namespace rths::broker {

/// Makes this process's writes visible to the fence of other processes' sleepers. Once, before the
/// first write.
void register_as_writer();

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
