// SPDX-License-Identifier: Apache-2.0
#include <rths/core/clock.hpp>

#include <cerrno>
#include <ctime>

namespace rths {
namespace {

constexpr long kNanosecondsPerSecond = 1'000'000'000;

}  // namespace

TimePoint WallClock::now() const noexcept {
  timespec ts{};
  clock_gettime(CLOCK_MONOTONIC, &ts);
  return TimePoint{ts.tv_sec * kNanosecondsPerSecond + ts.tv_nsec};
}

void WallClock::sleep_until(TimePoint time) noexcept {
  const timespec ts{time.count() / kNanosecondsPerSecond, time.count() % kNanosecondsPerSecond};
  // Resumes an interrupted sleep. The absolute wake-up time bounds the loop.
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &ts, nullptr) == EINTR) {
  }
}

}  // namespace rths
