// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <bit>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/broker/ring.hpp>
#include <rths/memmap/codec.hpp>

#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/realtime_guard.hpp"
#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using test::kControllerWord;
using test::kMachineWord;
using test::small_map;

constexpr LongwordOffset kGroupWord{3};

TEST(Ring, ShowsAWriteToEveryNode) {
  Ring ring = Ring::in_process(small_map());
  Node controller = ring.join("controller", 0);
  const Node machine = ring.join("machine", 0);
  const Node observer = ring.observe();

  EXPECT_EQ(controller.write(kControllerWord, 42), Status::Ok);

  EXPECT_EQ(machine.read(kControllerWord), 42U);
  EXPECT_EQ(observer.read(kControllerWord), 42U);
  EXPECT_EQ(controller.read(kControllerWord), 42U);
}

TEST(Ring, RefusesWritesToAnotherNodesPartition) {
  Ring ring = Ring::in_process(small_map());
  Node controller = ring.join("controller", 0);
  const std::array<std::uint32_t, 8> words{};

  EXPECT_EQ(controller.write(kMachineWord, 42), Status::Fault);
  EXPECT_EQ(controller.write(LongwordOffset{900}, 42), Status::Fault);  // no owner
  EXPECT_EQ(controller.write_group(TearGroupId{0}, words), Status::Fault);
  EXPECT_EQ(controller.write_group(TearGroupId{7}, words), Status::Fault);
  EXPECT_EQ(controller.read(kMachineWord), 0U);
}

TEST(Ring, ShowsItsWordsWithoutACopy) {
  Ring ring = Ring::in_process(small_map());
  Node controller = ring.join("controller", 0);
  const auto words = ring.observe().memory();

  EXPECT_EQ(controller.write(kControllerWord, 42), Status::Ok);

  EXPECT_EQ(words.size(), 1024U);
  EXPECT_EQ(words[kControllerWord.value()], 42U);
}

TEST(Ring, LetsOnlyPlainNodesStoreThroughAPointer) {
  Ring ring = Ring::in_process(small_map());
  Node controller = ring.join("controller", 0);
  Node machine = ring.join_plain("machine");

  ASSERT_EQ(machine.plain_memory().size(), 1024U);
  machine.plain_memory()[kMachineWord.value()] = 42;

  EXPECT_EQ(controller.read(kMachineWord), 42U);
  EXPECT_TRUE(controller.plain_memory().empty());
  EXPECT_TRUE(ring.observe().plain_memory().empty());
}

TEST(Ring, RefusesToWriteOrReadATearGroupPartially) {
  Ring ring = Ring::in_process(small_map());
  Node machine = ring.join("machine", 0);
  std::array<std::uint32_t, 7> too_few{};

  EXPECT_EQ(machine.write(kGroupWord, 42), Status::Fault);
  EXPECT_EQ(machine.write_group(TearGroupId{0}, too_few), Status::Fault);
  EXPECT_EQ(machine.read_group(TearGroupId{0}, too_few), Status::Fault);
  EXPECT_EQ(machine.read_group(TearGroupId{7}, too_few), Status::Fault);
}

TEST(Ring, RefusesWritesOfAnObserver) {
  Ring ring = Ring::in_process(small_map());
  Node observer = ring.observe();

  EXPECT_EQ(observer.write(kControllerWord, 1), Status::Fault);
  EXPECT_EQ(observer.write(kMachineWord, 1), Status::Fault);
}

TEST(Ring, BeginsWithTheInitialValuesOfItsMap) {
  Ring ring = Ring::in_process(small_map());

  EXPECT_EQ(std::bit_cast<float>(ring.observe().read(kControllerWord)), 2.5F);
}

TEST(Ring, ReadsATearGroupAsItWasWritten) {
  Ring ring = Ring::in_process(small_map());
  Node machine = ring.join("machine", 0);
  const TearGroupId group = ring.tear_group("fbk");
  const std::array<std::uint32_t, 8> sent{1, 2, 3, 4, 5, 6, 7, 8};
  std::array<std::uint32_t, 8> received{};

  ASSERT_EQ(machine.write_group(group, sent), Status::Ok);
  ASSERT_EQ(ring.observe().read_group(group, received), Status::Ok);

  EXPECT_EQ(received, sent);
}

TEST(Ring, RefusesAPartitionThatIsNotATearGroup) {
  const Ring ring = Ring::in_process(small_map());

  EXPECT_EQ(test::error_of([&] { static_cast<void>(ring.tear_group("ref")); }),
            "partition 'ref' of map 'small' is not a tear group");
}

TEST(Ring, RefusesANodeThatWasBuiltForAnotherMap) {
  Ring ring = Ring::in_process(small_map());

  const std::string error =
      test::error_of([&] { static_cast<void>(ring.join("machine", 0x1234)); });

  EXPECT_NE(error.find("was built for map 0000000000001234, the ring has map 'small'"),
            std::string::npos)
      << error;
  EXPECT_EQ(test::error_of([&] { static_cast<void>(ring.join("machine", ring.map().hash())); }),
            "");
}

TEST(Ring, RefusesASecondNodeOfTheSameName) {
  Ring ring = Ring::in_process(small_map());
  const Node machine = ring.join("machine", 0);

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(ring.join("machine", 0));
            }).find("node 'machine' is already on the ring, as process"),
            std::string::npos);
}

TEST(Ring, ListsItsNodesWhenANameIsUnknown) {
  Ring ring = Ring::in_process(small_map());

  EXPECT_EQ(test::error_of([&] { static_cast<void>(ring.join("machin", 0)); }),
            "map 'small' has no node 'machin', expected one of machine, controller");
}

TEST(Ring, ReusesTheSlotOfANodeThatLeft) {
  Ring ring = Ring::in_process(small_map());
  for (int i = 0; i < 100; ++i) {
    const Node machine = ring.join("machine", 0);
    EXPECT_EQ(machine.presence_of(NodeId{1}).state, Presence::State::Alive);
  }

  EXPECT_EQ(ring.observe().presence_of(NodeId{1}).state, Presence::State::Absent);
}

TEST(Ring, ReportsThatItIsFull) {
  Ring ring = Ring::in_process(small_map());
  std::vector<Node> observers;

  const std::string error = test::error_of([&] {
    for (int i = 0; i < 100; ++i) observers.push_back(ring.observe());
  });

  EXPECT_EQ(error, "the ring is full: 32 processes are on it");
}

TEST(Ring, CountsTheBeatsOfEachNode) {
  Ring ring = Ring::in_process(small_map());
  Node machine = ring.join("machine", 0);
  const Node observer = ring.observe();

  EXPECT_EQ(observer.beats_of(NodeId{1}), 0U);
  machine.beat();
  machine.beat();

  EXPECT_EQ(observer.beats_of(NodeId{1}), 2U);
  EXPECT_EQ(observer.beats_of(NodeId{2}), 0U);
}

TEST(Node, StaysOnTheRingWhenItIsMoved) {
  Ring ring = Ring::in_process(small_map());
  Node first = ring.join("machine", 0);
  Node second = std::move(first);

  EXPECT_EQ(second.write(kMachineWord, 9), Status::Ok);
  EXPECT_EQ(second.presence_of(NodeId{1}).state, Presence::State::Alive);
}

// Before the first write the record is disabled, so readers read the group from memory.
TEST(TearGroup, IsNotReadTornWhileItIsWrittenForTheFirstTime) {
  constexpr std::uint32_t kWords = 100;
  const std::vector<std::uint32_t> ones(kWords, 1);
  const int trials = test::Repetitions{5000, 500, 200}.count();
  long torn = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Ring ring = Ring::in_process(small_map(kWords));
    Node machine = ring.join("machine", 0);
    const Node reader = ring.observe();
    const TearGroupId group = ring.tear_group("fbk");
    std::atomic<bool> reading{false};
    std::thread thread{[&] {
      std::vector<std::uint32_t> words(kWords);
      do {
        ASSERT_EQ(reader.read_group(group, words), Status::Ok);
        for (const std::uint32_t word : words) torn += word != words[0] ? 1 : 0;
        reading.store(true);
      } while (words[0] == 0);
    }};
    while (!reading.load()) std::this_thread::yield();
    ASSERT_EQ(machine.write_group(group, ones), Status::Ok);
    thread.join();
  }

  EXPECT_EQ(torn, 0);
}

// Every word of a group has the count of its write, so two counts in one read would show a torn
// group. One thread writes, two read.
TEST(TearGroup, IsNeverReadTorn) {
  constexpr std::uint32_t kWords = 100;
  const auto writes =
      static_cast<std::uint32_t>(test::Repetitions{200'000, 200'000, 40'000}.count());
  Ring ring = Ring::in_process(small_map(kWords));
  Node machine = ring.join("machine", 0);
  const TearGroupId group = ring.tear_group("fbk");
  std::atomic<bool> finished{false};
  const auto watch = [&](const Node& reader, long& reads, long& torn) {
    std::vector<std::uint32_t> words(kWords);
    while (!finished.load()) {
      if (reader.read_group(group, words) != Status::Ok) continue;
      ++reads;
      for (const std::uint32_t word : words) torn += word != words[0] ? 1 : 0;
    }
  };
  const Node first = ring.observe();
  const Node second = ring.observe();
  std::array<long, 2> reads{};
  std::array<long, 2> torn{};
  std::thread one{[&] { watch(first, reads[0], torn[0]); }};
  std::thread two{[&] { watch(second, reads[1], torn[1]); }};
  std::vector<std::uint32_t> words(kWords);
  for (std::uint32_t count = 1; count <= writes; ++count) {
    std::fill(words.begin(), words.end(), count);
    ASSERT_EQ(machine.write_group(group, words), Status::Ok);
    // Lets readers run on a host with few processors.
    if (count % 1000 == 0) std::this_thread::yield();
  }
  finished.store(true);
  one.join();
  two.join();

  EXPECT_EQ(torn[0] + torn[1], 0);
  EXPECT_GT(reads[0] + reads[1], 0);
}

// A flag that is written after its data is never seen before the data. The handshake relies on it.
TEST(Ring, ShowsAFlagOnlyAfterTheDataItGuards) {
  constexpr std::uint32_t kRounds = 100'000;
  Ring ring = Ring::in_process(small_map());
  Node controller = ring.join("controller", 0);
  const Node observer = ring.observe();
  long early = 0;
  std::thread reader{[&] {
    std::uint32_t flag = 0;
    while (flag < kRounds) {
      flag = observer.read(LongwordOffset{513});
      const std::uint32_t data = observer.read(LongwordOffset{514});
      early += data < flag ? 1 : 0;
    }
  }};
  for (std::uint32_t round = 1; round <= kRounds; ++round) {
    static_cast<void>(controller.write(LongwordOffset{514}, round));
    static_cast<void>(controller.write(LongwordOffset{513}, round));
  }
  reader.join();

  EXPECT_EQ(early, 0);
}

class NodeOf : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(NodeOf, WorksInRealTime) {
  Ring ring = Ring::in_process(small_map(GetParam()));
  Node machine = ring.join("machine", 0);
  const TearGroupId group = ring.tear_group("fbk");
  std::vector<std::uint32_t> words(GetParam());
  std::uint64_t sum = 0;
  Status status = Status::Ok;
  // Enough writes to pass every hint and the end of the journal.
  const auto write_and_read_often = [&] {
    for (int i = 0; i < 2'000; ++i) {
      status = worst(status, machine.write_group(group, words));
      status = worst(status, machine.read_group(group, words));
      status = worst(status, machine.read_group(group, words));
      status = worst(status, machine.write(kMachineWord, 7));
    }
  };
  EXPECT_REALTIME(write_and_read_often());
  EXPECT_REALTIME(sum += machine.read(kControllerWord));
  EXPECT_REALTIME(status = worst(status, machine.write(kMachineWord, 7)));
  EXPECT_REALTIME(status = worst(status, machine.write_group(group, words)));
  EXPECT_REALTIME(status = worst(status, machine.read_group(group, words)));
  EXPECT_REALTIME(machine.beat());
  EXPECT_REALTIME(sum += machine.beats_of(NodeId{1}));
  EXPECT_EQ(status, Status::Ok);
  EXPECT_GT(sum, 0U);
}

INSTANTIATE_TEST_SUITE_P(Words, NodeOf, ::testing::Values(5, 15, 100));

}  // namespace
}  // namespace rths::broker
