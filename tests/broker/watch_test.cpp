// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <thread>

#include <gtest/gtest.h>

#include <rths/broker/follow.hpp>
#include <rths/broker/watch.hpp>

#include "broker/src/segment.hpp"
#include "support/files.hpp"
#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using std::chrono::milliseconds;
using test::kControllerWord;
using test::kMachineWord;
using test::RingRemoval;
using test::small_map;
using test::unique_ring;

constexpr LongwordOffset kUnownedWord{505};

/// A ring with a controller that journals its writes, and a plain pointer into the ring.
class WatchTest : public ::testing::Test {
 protected:
  std::string name = unique_ring(std::string{"watch_"} +
                                 ::testing::UnitTest::GetInstance()->current_test_info()->name());
  RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map(), 8);
  std::unique_ptr<Segment> segment = Segment::attach_shared(name);
  Node controller = ring.join("controller", 0);

  void store(LongwordOffset offset, std::uint32_t value) {
    segment->words()[offset.value()] = value;
  }
  /// All stores that are reported within 0.2 s.
  static std::vector<PlainStore> look_long(Watch& watch) {
    std::vector<PlainStore> found;
    for (int i = 0; i < 40; ++i) {
      for (auto& store : watch.look()) found.push_back(store);
      std::this_thread::sleep_for(milliseconds{5});
    }
    return found;
  }
};

// Two watches would be two writers of a plain client's journal.
TEST_F(WatchTest, IsTheOnlyOneOfItsRingWhileItsProcessLives) {
  {
    const Watch watch{ring};
    EXPECT_EQ(test::error_of([&] { const Watch second{ring}; }),
              "process " + std::to_string(getpid()) +
                  " watches the ring, expected one watch of a ring; end that process");
  }
  constexpr Claim kNoProcess = 1ULL << 40 | 999'999'999;
  segment->header().watcher = kNoProcess;

  EXPECT_EQ(test::error_of([&] { const Watch successor{ring}; }), "");
  EXPECT_EQ(segment->header().watcher, 0U);
}

TEST_F(WatchTest, ReportsNothingForNodesThatJournal) {
  Node machine = ring.join("machine", 0);
  Watch watch{ring};
  const std::array<std::uint32_t, 8> words{1, 2, 3, 4, 5, 6, 7, 8};
  ASSERT_EQ(controller.write(kControllerWord, 5), Status::Ok);
  ASSERT_EQ(machine.write_group(TearGroupId{0}, words), Status::Ok);

  EXPECT_TRUE(look_long(watch).empty());
}

TEST_F(WatchTest, ReportsNothingForANodeThatJoinsAndLeavesBetweenTwoLooks) {
  Watch watch{ring};
  ASSERT_EQ(ring.join("machine", 0).write(kMachineWord, 5), Status::Ok);

  EXPECT_TRUE(look_long(watch).empty());
}

TEST_F(WatchTest, JournalsAPlainClientsStoresIntoItsOwnWords) {
  const Node plain = ring.join_plain("machine");
  Watch watch{ring};
  Waiter waiter = ring.wait_for({{kMachineWord}});
  const TimePoint before = WallClock{}.now();
  static_cast<void>(watch.look());
  store(kMachineWord, 77);

  const auto found = watch.look();

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].offset, kMachineWord);
  EXPECT_EQ(found[0].owner, "machine");
  EXPECT_TRUE(found[0].allowed);
  Write write;
  ASSERT_EQ(waiter.wait(WallClock{}.now() + milliseconds{100}, write), Status::Ok);
  EXPECT_EQ(write.value, 77U);
  EXPECT_EQ(write.writer, NodeId{1});
  const LastWrite last = ring.last_write(kMachineWord);
  EXPECT_EQ(last.value, 77U);
  EXPECT_GE(last.not_before, before);
}

TEST_F(WatchTest, ReportsAStoreIntoAnotherNodesWord) {
  const Node plain = ring.join_plain("machine");
  Watch watch{ring};
  store(kControllerWord, 99);

  const auto found = look_long(watch);

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].offset, kControllerWord);
  EXPECT_EQ(found[0].value, 99U);
  EXPECT_EQ(found[0].owner, "controller");
  EXPECT_FALSE(found[0].allowed);
  EXPECT_EQ(found[0].others,
            std::vector<std::string>{"machine (process " + std::to_string(getpid()) + ")"});
}

// As the force of a controller that writes it in each tick.
TEST_F(WatchTest, ReportsAStoreThatTheOwnerOverwrites) {
  Watch watch{ring};
  ASSERT_EQ(controller.write(kControllerWord, 5), Status::Ok);
  controller.beat();
  EXPECT_TRUE(watch.look().empty());
  store(kControllerWord, 99);
  EXPECT_TRUE(watch.look().empty());
  EXPECT_TRUE(watch.has_suspicion());
  ASSERT_EQ(controller.write(kControllerWord, 6), Status::Ok);
  controller.beat();

  const auto found = watch.look();

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].value, 99U);
  EXPECT_EQ(found[0].owner, "controller");
  EXPECT_FALSE(watch.has_suspicion());
  EXPECT_TRUE(look_long(watch).empty());
}

TEST_F(WatchTest, ReportsStoresThatChangeFasterThanTheyAreJudged) {
  Watch watch{ring};
  std::size_t found = 0;
  for (std::uint32_t i = 0; i < 60; ++i) {
    store(kControllerWord, 100 + i);
    found += watch.look().size();
    std::this_thread::sleep_for(milliseconds{5});
  }

  EXPECT_GE(found, 1U);
}

TEST_F(WatchTest, ObservesBesideAWatchThatJournals) {
  const Node plain = ring.join_plain("machine");
  Watch journalling{ring};
  Watch observing{ring, Journalling::None};
  store(kMachineWord, 7);
  EXPECT_EQ(journalling.look().size(), 1U);
  EXPECT_TRUE(look_long(observing).empty());

  store(kMachineWord, 8);
  store(kControllerWord, 9);

  const auto found = look_long(observing);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].offset, kControllerWord);
  EXPECT_EQ(ring.last_write(kMachineWord).value, 7U);
}

TEST_F(WatchTest, LeavesTheStoresOfAPlainClientThatIsGoneToIt) {
  Watch observing{ring, Journalling::None};
  {
    const Node plain = ring.join_plain("machine");
    store(kMachineWord, 77);
  }

  EXPECT_TRUE(look_long(observing).empty());
}

TEST_F(WatchTest, ReportsAStoreIntoAWordWithoutOwner) {
  const Node plain = ring.join_plain("machine");
  Watch watch{ring};
  store(kUnownedWord, 1);

  const auto found = look_long(watch);

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].owner, "");
  EXPECT_FALSE(found[0].allowed);
}

// A writer may be stopped between a word and its journal entry. When the entry has come, the same
// value may be seen again before its entry: that is another write.
TEST_F(WatchTest, ForgetsASuspicionThatTheJournalHasResolved) {
  Watch watch{ring};
  store(kControllerWord, 1);  // not journalled yet
  EXPECT_TRUE(watch.look().empty());
  ASSERT_EQ(controller.write(kControllerWord, 1), Status::Ok);
  EXPECT_TRUE(watch.look().empty());
  std::this_thread::sleep_for(milliseconds{150});
  ASSERT_EQ(controller.write(kControllerWord, 0), Status::Ok);
  EXPECT_TRUE(watch.look().empty());

  store(kControllerWord, 1);  // not journalled yet

  EXPECT_TRUE(watch.look().empty());
}

TEST_F(WatchTest, ForgetsASuspicionWhenTheOwnerWritesAgainBetweenTwoLooks) {
  Watch watch{ring};
  store(kControllerWord, 1);  // not journalled yet
  EXPECT_TRUE(watch.look().empty());
  std::this_thread::sleep_for(milliseconds{150});
  ASSERT_EQ(controller.write(kControllerWord, 1), Status::Ok);
  ASSERT_EQ(controller.write(kControllerWord, 0), Status::Ok);

  store(kControllerWord, 1);  // not journalled yet

  EXPECT_TRUE(watch.look().empty());
}

TEST_F(WatchTest, WaitsForAnOwnerThatIsStoppedBeforeItsJournalEntry) {
  Watch watch{ring};
  controller.beat();
  store(kControllerWord, 1);  // not journalled yet

  EXPECT_TRUE(look_long(watch).empty());

  controller.beat();  // it has gone on without an entry
  const auto found = watch.look();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].owner, "controller");
  EXPECT_FALSE(found[0].allowed);
}

// Another plain client is on the ring and must not be blamed.
TEST_F(WatchTest, JournalsTheLastStoreOfAPlainClientThatLeaves) {
  const Node other = ring.join_plain("");
  Watch watch{ring};
  {
    const Node plain = ring.join_plain("machine");
    EXPECT_TRUE(watch.look().empty());
    store(kMachineWord, 77);
  }

  const auto found = look_long(watch);

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].owner, "machine");
  EXPECT_TRUE(found[0].allowed);
  EXPECT_EQ(ring.last_write(kMachineWord).value, 77U);
}

TEST_F(WatchTest, JournalsTheStoreOfAPlainClientThatJoinsAndLeavesBetweenTwoLooks) {
  const Node other = ring.join_plain("");
  Watch watch{ring};
  {
    const Node plain = ring.join_plain("machine");
    store(kMachineWord, 77);
  }

  const auto found = look_long(watch);

  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].allowed);
  EXPECT_EQ(ring.last_write(kMachineWord).value, 77U);
}

TEST_F(WatchTest, LeavesTheJournalToANodeThatFollowsAPlainClient) {
  Watch watch{ring};
  {
    const Node plain = ring.join_plain("machine");
    EXPECT_TRUE(watch.look().empty());
    store(kMachineWord, 77);
  }
  Node machine = ring.join("machine", 0);
  ASSERT_EQ(machine.write(kMachineWord, 78), Status::Ok);

  EXPECT_TRUE(look_long(watch).empty());

  EXPECT_EQ(ring.last_write(kMachineWord).value, 78U);
}

// A plain client follows a node that journalled: its groups are read word by word from memory.
TEST_F(WatchTest, LeavesGroupsOfAPlainClientToItsPointer) {
  const std::array<std::uint32_t, 8> words{1, 2, 3, 4, 5, 6, 7, 8};
  {
    Node machine = ring.join("machine", 0);
    ASSERT_EQ(machine.write_group(TearGroupId{0}, words), Status::Ok);
  }
  Node plain = ring.join_plain("machine");
  std::array<std::uint32_t, 8> read{};

  store(LongwordOffset{3}, 44);

  ASSERT_EQ(controller.read_group(TearGroupId{0}, read), Status::Ok);
  EXPECT_EQ(read[3], 44U);
  EXPECT_EQ(plain.write(kMachineWord, 1), Status::Fault);
  EXPECT_EQ(plain.write_group(TearGroupId{0}, words), Status::Fault);
}

// Its stores may wait in a queue of traps.
TEST_F(WatchTest, KeepsAClientThatHasLeftUntilItsStoresAreTaken) {
  Watch watch{ring};
  Follower follower = ring.follow("machine");
  const auto leave = [](LongwordOffset) { return Judgement::Leave; };
  {
    const Node plain = ring.join_plain("machine");
    store(kMachineWord, 7);
  }
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(watch.look(leave).empty());
  Write write;
  EXPECT_EQ(follower.next(write), Followed::Nothing);
  ASSERT_TRUE(watch.is_plain("machine"));

  for (const std::uint32_t value : {5U, 6U, 7U}) watch.take("machine", kMachineWord, {value});
  EXPECT_TRUE(watch.look(leave).empty());

  EXPECT_FALSE(watch.is_plain("machine"));
  for (const std::uint32_t value : {5U, 6U, 7U}) {
    ASSERT_EQ(follower.next(write), Followed::Write);
    EXPECT_EQ(write.value, value);
  }
  EXPECT_EQ(follower.next(write), Followed::Nothing);
  EXPECT_TRUE(look_long(watch).empty());
}

}  // namespace
}  // namespace rths::broker
