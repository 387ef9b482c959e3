// SPDX-License-Identifier: Apache-2.0
//
// Sleeps until the next write. The sleeper executes the fence that this needs; the writer's side is
// in detail/wake.hpp.
#pragma once

#include <cstdint>

#include <rths/broker/detail/wake.hpp>
#include <rths/core/clock.hpp>

namespace rths::broker {

/// Includes this process in the fences of sleepers. Called once, before the first write.
void register_as_writer();

/// Marks a slot as sleeping during its lifetime. After construction, poll once more: every write
/// that this poll does not find will wake the sleeper.
class Sleeper {
 public:
  Sleeper(Wake& wake, std::uint32_t slot) noexcept;
  ~Sleeper();
  Sleeper(const Sleeper&) = delete;
  Sleeper& operator=(const Sleeper&) = delete;

  /// Sleeps until the next write, at most for `most`; may wake without a reason.
  void sleep(Duration most) noexcept;

 private:
  Wake& wake_;
  std::uint32_t bit_;
  std::uint32_t calls_;
};

}  // namespace rths::broker
