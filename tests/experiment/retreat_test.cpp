// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <rths/experiment/retreat.hpp>

#include "support/realtime_guard.hpp"

namespace rths::experiment {
namespace {

TEST(Retreat, HoldsThenRampsToRestWithoutAJump) {
  const Retreat retreat{0.2, 1.0};

  EXPECT_EQ(retreat.fraction(0), 1);
  EXPECT_EQ(retreat.fraction(0.2), 1);
  EXPECT_NEAR(retreat.fraction(0.7), 0.5, 1e-12);
  EXPECT_EQ(retreat.fraction(1.2), 0);
  EXPECT_FALSE(retreat.finished(1.19));
  EXPECT_TRUE(retreat.finished(1.2));
  for (double t = 0; t < 1.3; t += 0.001)
    EXPECT_LE(std::abs(retreat.fraction(t + 0.001) - retreat.fraction(t)), 0.002);
}

TEST(Retreat, WorksInRealTime) {
  const Retreat retreat;
  double fraction = 0;
  bool finished = false;
  EXPECT_REALTIME(fraction = retreat.fraction(0.5));
  EXPECT_REALTIME(finished = retreat.finished(0.5));
  EXPECT_GT(fraction, 0);
  EXPECT_FALSE(finished);
}

}  // namespace
}  // namespace rths::experiment
