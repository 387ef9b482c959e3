// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rths::test {

/// Detects forbidden operations of real-time functions on this thread during its lifetime: heap
/// calls (including those of exceptions), mutex locks and system calls.
///
///     RealTimeGuard guard;
///     loop.step();
///     EXPECT_EQ(guard.heap_calls(), 0);
///
/// Or in one line: EXPECT_REALTIME(loop.step());
class RealTimeGuard {
 public:
  RealTimeGuard();
  ~RealTimeGuard();
  RealTimeGuard(const RealTimeGuard&) = delete;
  RealTimeGuard& operator=(const RealTimeGuard&) = delete;

  /// False under sanitizers, which replace the same functions.
  [[nodiscard]] static bool supported();
  /// Whether system calls are detected: on x86-64 with kernel 5.11 or later.
  [[nodiscard]] static bool sees_system_calls();

  [[nodiscard]] long heap_calls() const;
  [[nodiscard]] long locks() const;
  /// Number of the first system call, −1 if there was none.
  [[nodiscard]] long first_system_call() const;
};

}  // namespace rths::test

/// Runs a statement and expects no operation that is forbidden in a control loop. The statement
/// first runs once without the guard, to exclude one-time costs of the C library.
#define EXPECT_REALTIME(statement)                                                   \
  do {                                                                               \
    if (!::rths::test::RealTimeGuard::supported()) {                                 \
      GTEST_SKIP() << "SKIPPED: the real-time guard does not work under sanitizers"; \
    }                                                                                \
    statement;                                                                       \
    long heap_calls = 0;                                                             \
    long locks = 0;                                                                  \
    long system_call = -1;                                                           \
    {                                                                                \
      const ::rths::test::RealTimeGuard guard;                                       \
      statement;                                                                     \
      heap_calls = guard.heap_calls();                                               \
      locks = guard.locks();                                                         \
      system_call = guard.first_system_call();                                       \
    }                                                                                \
    EXPECT_EQ(heap_calls, 0) << #statement " allocates";                             \
    EXPECT_EQ(locks, 0) << #statement " locks";                                      \
    EXPECT_EQ(system_call, -1) << #statement " makes this system call";              \
  } while (false)
