// SPDX-License-Identifier: Apache-2.0
//
// Tests that the guard detects each forbidden operation.
#include <unistd.h>

#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "support/realtime_guard.hpp"

namespace rths::test {
namespace {

class GuardTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!RealTimeGuard::supported()) GTEST_SKIP() << "SKIPPED: no guard under sanitizers";
  }
};
using RealTimeGuardTest = GuardTest;

TEST_F(RealTimeGuardTest, SeesAVectorGrow) {
  std::vector<int> values;
  const RealTimeGuard guard;
  values.push_back(1);
  EXPECT_GT(guard.heap_calls(), 0);
}

TEST_F(RealTimeGuardTest, SeesAnException) {
  long heap_calls = 0;
  try {
    const RealTimeGuard guard;
    try {
      throw std::runtime_error{"x"};
    } catch (...) {
      heap_calls = guard.heap_calls();
      throw;
    }
  } catch (const std::runtime_error&) {
  }
  EXPECT_GT(heap_calls, 0);
}

TEST_F(RealTimeGuardTest, SeesALock) {
  std::mutex mutex;
  const RealTimeGuard guard;
  mutex.lock();
  mutex.unlock();
  EXPECT_EQ(guard.locks(), 1);
}

TEST_F(RealTimeGuardTest, SeesASystemCall) {
  if (!RealTimeGuard::sees_system_calls())
    GTEST_SKIP() << "SKIPPED: this kernel cannot dispatch system calls to their caller";
  long call = -1;
  {
    const RealTimeGuard guard;
    static_cast<void>(getppid());
    call = guard.first_system_call();
  }
  EXPECT_EQ(call, 110);  // getppid on x86-64
}

TEST_F(RealTimeGuardTest, IsQuietAboutArithmetic) {
  double x = 1;
  EXPECT_REALTIME(x = x * 1.5 + 2);
  EXPECT_GT(x, 1);
}

}  // namespace
}  // namespace rths::test
