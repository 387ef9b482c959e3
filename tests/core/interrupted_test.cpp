// SPDX-License-Identifier: Apache-2.0
#include <rths/core/interrupted.hpp>

#include <csignal>

#include <gtest/gtest.h>

namespace rths {
namespace {

TEST(Interruptible, StopsAtTheNextPlaceAfterASignal) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    const Interruptible interruptible;
    EXPECT_NO_THROW(stop_if_interrupted());

    std::raise(signal);

    EXPECT_THROW(stop_if_interrupted(), Interrupted);
  }
  EXPECT_NO_THROW(stop_if_interrupted());
}

TEST(InterruptibleDeathTest, EndsTheProcessAtASecondSignal) {
  EXPECT_EXIT(
      {
        const Interruptible interruptible;
        std::raise(SIGINT);
        std::raise(SIGTERM);
      },
      testing::KilledBySignal(SIGTERM), "");
}

TEST(Interruptible, LeavesIgnoredSignalsIgnored) {
  const auto before = std::signal(SIGHUP, SIG_IGN);
  {
    const Interruptible interruptible;
    std::raise(SIGHUP);
    EXPECT_NO_THROW(stop_if_interrupted());
  }
  std::signal(SIGHUP, before);
}

}  // namespace
}  // namespace rths
