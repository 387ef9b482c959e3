// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include <rths/core/realtime.hpp>

namespace rths {

/// Time since the origin of a run's clock.
using TimePoint = std::chrono::nanoseconds;
using Duration = std::chrono::nanoseconds;

/// Seconds as a floating-point number, as the physics uses them [s].
[[nodiscard]] constexpr double to_seconds(Duration duration) noexcept {
  return std::chrono::duration<double>(duration).count();
}
[[nodiscard]] constexpr Duration from_seconds(double seconds) noexcept {
  return Duration{static_cast<Duration::rep>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5))};
}

/// Clock of a run: wall time or virtual time behind one interface.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Time now. @realtime
  [[nodiscard]] virtual TimePoint now() const RTHS_REALTIME = 0;
  /// Sleeps until `time`; returns at once if it has passed. The only wait of a control loop.
  /// @realtime
  virtual void sleep_until(TimePoint time) RTHS_REALTIME = 0;
};

/// The host's monotonic clock. All processes of one host share it. @any_thread
class WallClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const RTHS_REALTIME override;
  void sleep_until(TimePoint time) RTHS_REALTIME override;
};

/// Clock of a run in virtual time: only `sleep_until` advances it, in one jump. One thread.
class VirtualClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const RTHS_REALTIME override { return now_; }
  void sleep_until(TimePoint time) RTHS_REALTIME override {
    if (time > now_) now_ = time;
  }

 private:
  TimePoint now_{0};
};

}  // namespace rths
