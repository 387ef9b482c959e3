// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/broker/follow.hpp>

#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/realtime_guard.hpp"
#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using std::chrono::milliseconds;
using test::kControllerWord;
using test::kMachineWord;
using test::small_map;

class FollowTest : public ::testing::Test {
 protected:
  Ring ring = Ring::in_process(small_map(), 6);
  Node machine = ring.join("machine", 0);
  Node controller = ring.join("controller", 0);
  std::array<std::uint32_t, 8> group{1, 2, 3, 4, 5, 6, 7, 8};
  Write write;

  [[nodiscard]] static TimePoint in(Duration time) { return WallClock{}.now() + time; }
};

TEST_F(FollowTest, SeesEveryWriteOnceAndInOrder) {
  ASSERT_EQ(machine.write(kMachineWord, 1), Status::Ok);  // before it follows
  Follower follower = ring.follow("machine");

  ASSERT_EQ(machine.write(kMachineWord, 2), Status::Ok);
  ASSERT_EQ(machine.write_group(TearGroupId{0}, group), Status::Ok);
  machine.beat();
  ASSERT_EQ(machine.write(kMachineWord, 2), Status::Ok);  // the same value again
  ASSERT_EQ(controller.write(kControllerWord, 9), Status::Ok);

  ASSERT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(write.writer, NodeId{1});
  EXPECT_EQ(write.offset, kMachineWord);
  EXPECT_EQ(write.value, 2U);
  ASSERT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(write.offset, LongwordOffset{0});
  EXPECT_TRUE(std::equal(write.group.begin(), write.group.end(), group.begin(), group.end()));
  ASSERT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(write.offset, kMachineWord);
  EXPECT_EQ(follower.next(write), Followed::Nothing);
}

// Reads while each group is being journalled: the writer waits for the follower before the next.
TEST_F(FollowTest, SeesEveryGroupThatIsWrittenConcurrently) {
  constexpr std::uint32_t kWords = 60;
  const std::uint32_t writes = test::is_long() ? 50'000 : 10'000;
  Ring wide = Ring::in_process(small_map(kWords), 10);
  Node writer = wide.join("machine", 0);
  Follower follower = wide.follow("machine");
  const TimePoint end = in(std::chrono::seconds{30});  // a busy host switches threads rarely
  std::atomic<std::uint32_t> followed{0}, last{writes};
  std::thread thread{[&] {
    for (std::uint32_t count = 1; count <= last.load(); ++count) {
      while (followed.load() + 1 < count) std::this_thread::yield();
      const std::vector<std::uint32_t> words(kWords, count);
      static_cast<void>(writer.write_group(TearGroupId{0}, words));
      static_cast<void>(writer.write(kMachineWord, count));
      if (WallClock{}.now() > end) last.store(count);
    }
  }};
  std::uint32_t groups = 0;
  while (followed.load() < last.load()) {
    if (follower.next(write) != Followed::Write)
      std::this_thread::yield();
    else if (write.group.empty())
      followed.store(write.value);
    else
      ++groups;
  }
  thread.join();

  EXPECT_EQ(groups, last.load());
  EXPECT_GT(groups, 1000U);
  EXPECT_EQ(follower.lost(), 0U);
}

TEST_F(FollowTest, ReportsLostWritesWhenItFallsBehind) {
  Follower follower = ring.follow("machine");
  for (std::uint32_t i = 0; i < 200; ++i) ASSERT_EQ(machine.write(kMachineWord, i), Status::Ok);

  EXPECT_EQ(follower.next(write), Followed::Lost);
  EXPECT_EQ(follower.lost(), 200U);
  EXPECT_EQ(follower.next(write), Followed::Nothing);
  ASSERT_EQ(machine.write(kMachineWord, 777), Status::Ok);
  ASSERT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(write.value, 777U);
}

TEST_F(FollowTest, FollowsTheSuccessorOfANode) {
  Follower follower = ring.follow("machine");
  { const Node gone = std::move(machine); }
  Node successor = ring.join("machine", 0);
  ASSERT_EQ(successor.write(kMachineWord, 5), Status::Ok);

  ASSERT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(write.value, 5U);
}

TEST_F(FollowTest, WaitsForOneWordAmongMany) {
  Waiter waiter = ring.wait_for({{LongwordOffset{513}}});
  ASSERT_EQ(controller.write(kControllerWord, 1), Status::Ok);
  ASSERT_EQ(machine.write(kMachineWord, 2), Status::Ok);
  ASSERT_EQ(controller.write(LongwordOffset{513}, 3), Status::Ok);

  ASSERT_EQ(waiter.wait(in(milliseconds{100}), write), Status::Ok);

  EXPECT_EQ(write.offset, LongwordOffset{513});
  EXPECT_EQ(write.value, 3U);
  EXPECT_EQ(waiter.wait(in(milliseconds{1}), write), Status::Late);
}

TEST_F(FollowTest, WaitsForSomeWordsOfAGroup) {
  Waiter waiter = ring.wait_for({{LongwordOffset{6}, 2}});
  ASSERT_EQ(machine.write_group(TearGroupId{0}, group), Status::Ok);

  ASSERT_EQ(waiter.wait(in(milliseconds{100}), write), Status::Ok);

  EXPECT_EQ(write.group.size(), 8U);
}

TEST_F(FollowTest, WaitsForAnyWriteAtAll) {
  Waiter waiter = ring.wait_for({});
  ASSERT_EQ(machine.write(kMachineWord, 2), Status::Ok);
  ASSERT_EQ(controller.write(kControllerWord, 3), Status::Ok);
  std::uint32_t sum = 0;

  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(waiter.wait(in(milliseconds{100}), write), Status::Ok);
    sum += write.value;
  }

  EXPECT_EQ(sum, 5U);
}

TEST_F(FollowTest, DoesNotWaitLongerThanItsDeadline) {
  Waiter waiter = ring.wait_for({{kMachineWord}});
  const TimePoint deadline = in(milliseconds{30});

  EXPECT_EQ(waiter.wait(deadline, write), Status::Late);

  EXPECT_GE(WallClock{}.now(), deadline);
}

TEST_F(FollowTest, ReportsLostWritesWhileWaiting) {
  Waiter waiter = ring.wait_for({{kMachineWord}});
  for (std::uint32_t i = 0; i < 200; ++i) ASSERT_EQ(machine.write(kMachineWord, i), Status::Ok);

  EXPECT_EQ(waiter.wait(in(milliseconds{100}), write), Status::LimitExceeded);
}

TEST_F(FollowTest, RefusesToWaitForWordsWithoutAWriter) {
  EXPECT_EQ(test::error_of([&] { static_cast<void>(ring.wait_for({{LongwordOffset{900}}})); }),
            "no node may write the words to wait for");
}

// Every write wakes a sleeping waiter: two threads miss no write, in either order of events.
TEST_F(FollowTest, IsWokenByEveryWrite) {
  constexpr std::uint32_t kRounds = 300;
  std::thread echo{[&] {
    Waiter waiter = ring.wait_for({{kControllerWord}});
    Write seen;
    ASSERT_EQ(machine.write(kMachineWord, 0), Status::Ok);  // ready
    for (std::uint32_t round = 1; round <= kRounds; ++round) {
      ASSERT_EQ(waiter.wait(in(std::chrono::seconds{10}), seen), Status::Ok);
      ASSERT_EQ(machine.write(kMachineWord, seen.value), Status::Ok);
    }
  }};
  Waiter waiter = ring.wait_for({{kMachineWord}});
  for (std::uint32_t i = 0; controller.read(kMachineWord) != 0 && i < 100; ++i)
    std::this_thread::sleep_for(milliseconds{10});
  std::this_thread::sleep_for(milliseconds{20});
  while (waiter.wait(in(milliseconds{1}), write) == Status::Ok) {
  }
  for (std::uint32_t round = 1; round <= kRounds; ++round) {
    if (round % 10 == 0) std::this_thread::sleep_for(milliseconds{1});  // let it fall asleep
    ASSERT_EQ(controller.write(kControllerWord, round), Status::Ok);
    ASSERT_EQ(waiter.wait(in(std::chrono::seconds{10}), write), Status::Ok);
    EXPECT_EQ(write.value, round);
  }
  echo.join();
}

TEST_F(FollowTest, FindsWriterAndTimeOfTheLastWrite) {
  controller.beat();
  const TimePoint before = WallClock{}.now();
  controller.beat();
  ASSERT_EQ(controller.write(kControllerWord, 41), Status::Ok);
  ASSERT_EQ(controller.write(kControllerWord, 42), Status::Ok);
  controller.beat();
  const TimePoint after = WallClock{}.now();

  const LastWrite last = ring.last_write(kControllerWord);

  EXPECT_EQ(last.node, "controller");
  EXPECT_EQ(last.value, 42U);
  EXPECT_GE(last.not_before, before);
  EXPECT_LE(last.not_after, after);
  EXPECT_LE(last.not_before, last.not_after);
}

TEST_F(FollowTest, FindsTheLastWriteOfAWordInsideAGroup) {
  ASSERT_EQ(machine.write_group(TearGroupId{0}, group), Status::Ok);

  EXPECT_EQ(ring.last_write(LongwordOffset{5}).value, 6U);
}

TEST_F(FollowTest, BoundsTheAgeOfAWordWhoseWriteLeftTheJournal) {
  ASSERT_EQ(controller.write(kControllerWord, 41), Status::Ok);
  for (std::uint32_t i = 0; i < 200; ++i) {
    ASSERT_EQ(controller.write(LongwordOffset{513}, i), Status::Ok);
    if (i % 10 == 0) controller.beat();
  }

  const LastWrite last = ring.last_write(kControllerWord);

  EXPECT_EQ(last.node, "controller");
  EXPECT_FALSE(last.value.has_value());
  EXPECT_GT(last.not_after.count(), 0);
  EXPECT_LT(last.not_after, WallClock{}.now());
}

TEST_F(FollowTest, FindsNoWriterForAWordInNoPartition) {
  EXPECT_EQ(ring.last_write(LongwordOffset{900}).node, "");
}

TEST_F(FollowTest, FollowsInRealTime) {
  Follower follower = ring.follow("machine");
  Waiter waiter = ring.wait_for({{kMachineWord}});
  ASSERT_EQ(machine.write(kMachineWord, 1), Status::Ok);
  ASSERT_EQ(machine.write(kMachineWord, 2), Status::Ok);
  Followed followed = Followed::Nothing;
  Status status = Status::Late;
  EXPECT_REALTIME(followed = follower.next(write));
  EXPECT_REALTIME(status = waiter.wait(in(milliseconds{100}), write));
  EXPECT_EQ(followed, Followed::Write);
  EXPECT_EQ(status, Status::Ok);
}

}  // namespace
}  // namespace rths::broker
