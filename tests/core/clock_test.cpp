// SPDX-License-Identifier: Apache-2.0
#include <sys/syscall.h>

#include <gtest/gtest.h>

#include <rths/core/clock.hpp>

#include "support/realtime_guard.hpp"

namespace rths {
namespace {

using std::chrono::milliseconds;

TEST(WallClock, DoesNotReturnBeforeTheRequestedTime) {
  WallClock clock;
  const TimePoint due = clock.now() + milliseconds{2};

  clock.sleep_until(due);

  EXPECT_GE(clock.now(), due);
}

TEST(WallClock, ReturnsAtOnceWhenTheTimeHasPassed) {
  WallClock clock;
  const TimePoint begun = clock.now();

  clock.sleep_until(begun - milliseconds{1000});

  EXPECT_LT(clock.now() - begun, milliseconds{500});
}

TEST(WallClock, ReadsTheTimeInRealTime) {
  const WallClock clock;
  TimePoint time{};
  EXPECT_REALTIME(time = clock.now());
  EXPECT_GT(time.count(), 0);
}

TEST(WallClock, SleepsWithOneSystemCallAndNothingElse) {
  if (!test::RealTimeGuard::supported() || !test::RealTimeGuard::sees_system_calls())
    GTEST_SKIP() << "SKIPPED: the real-time guard sees no system calls here";
  WallClock clock;
  const TimePoint until = clock.now() + milliseconds{1};
  long heap_calls = 0;
  long locks = 0;
  long system_call = 0;
  {
    const test::RealTimeGuard guard;
    clock.sleep_until(until);
    heap_calls = guard.heap_calls();
    locks = guard.locks();
    system_call = guard.first_system_call();
  }

  EXPECT_GE(clock.now(), until);
  EXPECT_EQ(heap_calls, 0);
  EXPECT_EQ(locks, 0);
  EXPECT_EQ(system_call, SYS_clock_nanosleep);
}

TEST(VirtualClock, AdvancesOnlyBySleeping) {
  VirtualClock clock;
  const TimePoint before = clock.now();

  EXPECT_EQ(clock.now(), before);
  clock.sleep_until(milliseconds{5});
  EXPECT_EQ(clock.now(), milliseconds{5});
}

TEST(VirtualClock, NeverGoesBack) {
  VirtualClock clock;
  clock.sleep_until(milliseconds{5});

  clock.sleep_until(milliseconds{3});

  EXPECT_EQ(clock.now(), milliseconds{5});
}

TEST(VirtualClock, WorksInRealTime) {
  VirtualClock clock;
  EXPECT_REALTIME(clock.sleep_until(clock.now() + milliseconds{1}));
}

TEST(Seconds, ConvertBothWaysToTheNanosecond) {
  EXPECT_EQ(from_seconds(0.0003), Duration{300'000});
  EXPECT_EQ(from_seconds(-1.5), Duration{-1'500'000'000});
  EXPECT_DOUBLE_EQ(to_seconds(Duration{41'425'000'000}), 41.425);
}

}  // namespace
}  // namespace rths
