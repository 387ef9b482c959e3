// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "launch/src/peer_watch.hpp"
#include "support/ring_maps.hpp"

namespace rths::launch {
namespace {

using std::chrono::milliseconds;

constexpr Duration kLook = milliseconds{20};

TEST(Silence, IsTheTimeSinceTheLastSignOfLife) {
  Silence silence;
  Duration observed{0};
  for (int look = 0; look <= 50; ++look) observed = silence.look(look * kLook, 7);

  EXPECT_EQ(observed, milliseconds{1000});
  EXPECT_EQ(silence.look(51 * kLook, 8), Duration{0});
}

// The host stopped the watching process as well, so nobody knows whether the other one was silent.
TEST(Silence, DoesNotCountThePausesOfTheWatchingProcess) {
  Silence silence;
  static_cast<void>(silence.look(milliseconds{0}, 7));

  EXPECT_EQ(silence.look(milliseconds{5000}, 7), milliseconds{100});
}

/// A controller that watches a machine.
class PeerWatchTest : public ::testing::Test {
 protected:
  static Experiment experiment() {
    Experiment both;
    for (const char* node : {"machine", "controller"}) both.nodes.emplace_back().node = node;
    return both;
  }
  /// Looks every 20 ms for a second. @returns the time of the first trouble, or a second
  Duration find_trouble(bool machine_runs, bool controller_runs) {
    for (Duration end = now + milliseconds{1000}; now < end; now += kLook) {
      if (machine_runs) machine.beat();
      if (controller_runs) controller.beat();
      if (watch.find_trouble(now)) return now;
    }
    return now;
  }

  memmap::Map map = test::small_map();
  broker::Ring ring = broker::Ring::in_process(map);
  broker::Node machine = ring.join("machine", 0);
  broker::Node controller = ring.join("controller", 0);
  PeerWatch watch{controller, map, experiment(), "controller"};
  TimePoint now{0};
};

TEST_F(PeerWatchTest, FindsASilentPeerAfterHalfASecond) {
  EXPECT_EQ(find_trouble(true, true), milliseconds{1000});
  EXPECT_NEAR(to_seconds(find_trouble(false, true)), 1.5, 0.05);
}

TEST_F(PeerWatchTest, FindsNothingWhileTheWatchingNodeItselfStands) {
  EXPECT_EQ(find_trouble(true, true), milliseconds{1000});
  EXPECT_EQ(find_trouble(false, false), milliseconds{2000});
}

// After a pause of the host, the watching node catches up before its peer runs again.
TEST_F(PeerWatchTest, FindsNothingWhenTheHostStoodStill) {
  EXPECT_EQ(find_trouble(true, true), milliseconds{1000});
  now += milliseconds{3000};
  for (int step = 0; step < 3000; ++step) controller.beat();

  EXPECT_EQ(watch.find_trouble(now), std::nullopt);
}

TEST_F(PeerWatchTest, DoesNotMissAPeerThatLeftInOrder) {
  EXPECT_EQ(find_trouble(true, true), milliseconds{1000});
  { const broker::Node gone = std::move(machine); }

  EXPECT_EQ(find_trouble(false, true), milliseconds{2000});
}

}  // namespace
}  // namespace rths::launch
