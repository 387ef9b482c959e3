// SPDX-License-Identifier: Apache-2.0
//
// Rings of several hosts that gateways connect, over a relay with faults.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include <rths/broker/follow.hpp>

#include "broker/dds/src/clock_offset.hpp"
#include "broker/dds/src/frame.hpp"
#include "broker/dds/src/hello.hpp"
#include "hosts.hpp"
#include "relay.hpp"
#include "support/long_run.hpp"

namespace rths {
namespace {

using broker::Followed;
using broker::Presence;
using test::comes_true;
using test::kControllerWord;
using test::kMachineWord;
using test::RingHost;

constexpr std::uint32_t kGroupWords = 8;

class GatewayTest : public ::testing::Test {
 protected:
  std::shared_ptr<test::Relay> relay_ = std::make_shared<test::Relay>(1);
  memmap::Map map_ = test::small_map(kGroupWords);
  RingHost here_{"here", map_}, there_{"there", map_};

  void start() {
    here_.start(relay_->connect());
    there_.start(relay_->connect());
  }
  [[nodiscard]] static bool has(RingHost& host, const std::string& node) {
    const broker::Node reader = host.ring().observe();
    return reader.presence_of(host.ring().map().node(node)).state == Presence::State::Alive;
  }
};

TEST_F(GatewayTest, BringsWordsAndGroupsToTheOtherHost) {
  start();
  broker::Node machine = here_.ring().join("machine", 0);
  const broker::Node reader = there_.ring().observe();
  const auto group = there_.ring().tear_group("fbk");
  std::vector<std::uint32_t> sent(kGroupWords), read(kGroupWords);
  std::iota(sent.begin(), sent.end(), 100);

  ASSERT_EQ(machine.write(kMachineWord, 7), Status::Ok);
  ASSERT_EQ(machine.write_group(group, sent), Status::Ok);

  EXPECT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 7; }));
  EXPECT_TRUE(
      comes_true([&] { return reader.read_group(group, read) == Status::Ok && read == sent; }));
  EXPECT_TRUE(has(there_, "machine"));
}

TEST_F(GatewayTest, MakesRemoteWritesLookLikeLocalOnes) {
  start();
  auto follower = there_.ring().follow("machine");
  broker::Node machine = here_.ring().join("machine", 0);
  ASSERT_TRUE(comes_true([&] { return has(there_, "machine"); }));
  ASSERT_EQ(machine.write(kMachineWord, 11), Status::Ok);

  broker::Write write{};
  ASSERT_TRUE(comes_true([&] {
    return follower.next(write) == Followed::Write && write.offset == kMachineWord &&
           write.value == 11;
  }));
  EXPECT_EQ(there_.ring().last_write(kMachineWord).node, "machine");
}

TEST_F(GatewayTest, BringsTheWholeImageToALateHost) {
  here_.start(relay_->connect());
  broker::Node machine = here_.ring().join("machine", 0);
  broker::Node controller = here_.ring().join("controller", 0);
  for (std::uint32_t i = 0; i < 1000; ++i) ASSERT_EQ(machine.write(kMachineWord, i), Status::Ok);
  ASSERT_EQ(controller.write(kControllerWord, 12), Status::Ok);
  std::this_thread::sleep_for(std::chrono::milliseconds{100});

  there_.start(relay_->connect());

  const broker::Node reader = there_.ring().observe();
  EXPECT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 999; }));
  EXPECT_TRUE(comes_true([&] { return reader.read(kControllerWord) == 12; }));
  EXPECT_GE(there_.gateway().counts().snapshots, 2U);
}

TEST_F(GatewayTest, LetsHeartbeatsThroughAndLeavesWithTheNode) {
  start();
  {
    broker::Node machine = here_.ring().join("machine", 0);
    ASSERT_TRUE(comes_true([&] { return has(there_, "machine"); }));
    const broker::Node reader = there_.ring().observe();
    const NodeId id = there_.ring().map().node("machine");
    const auto before = reader.beats_of(id);
    machine.beat();
    EXPECT_TRUE(comes_true([&] { return reader.beats_of(id) > before; }));
    std::this_thread::sleep_for(std::chrono::milliseconds{200});
    const auto after = reader.beats_of(id);
    std::this_thread::sleep_for(std::chrono::milliseconds{200});
    EXPECT_EQ(reader.beats_of(id), after) << "a silent node is silent there too";
  }
  EXPECT_TRUE(comes_true([&] { return !has(there_, "machine"); }));
}

TEST_F(GatewayTest, RefusesANodeThatIsOnBothHosts) {
  broker::Node ours = here_.ring().join("machine", 0);
  broker::Node theirs = there_.ring().join("machine", 0);
  start();
  const auto refusals = [](RingHost& host) {
    const auto lines = host.lines();
    return std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
      return line.find("node 'machine' of host") != std::string::npos &&
             line.find("is refused") != std::string::npos;
    });
  };
  EXPECT_TRUE(comes_true([&] { return refusals(here_) == 1 && refusals(there_) == 1; }));
  ASSERT_EQ(ours.write(kMachineWord, 1), Status::Ok);
  ASSERT_EQ(theirs.write(kMachineWord, 2), Status::Ok);
  std::this_thread::sleep_for(std::chrono::milliseconds{200});
  EXPECT_EQ(ours.read(kMachineWord), 1U);
  EXPECT_EQ(theirs.read(kMachineWord), 2U);
  EXPECT_EQ(refusals(here_), 1) << "said once";
}

// A refused node of another host is announced again and again.
TEST_F(GatewayTest, LosesNoWriteOfANodeWhileItRefusesTheSameNodeOfAnotherHost) {
  RingHost third{"third", map_};
  here_.start(relay_->connect());
  third.start(relay_->connect());
  broker::Node ours = here_.ring().join("machine", 0);
  ASSERT_TRUE(comes_true([&] { return has(third, "machine"); }));
  // The first values may come with the snapshot for a new host, which holds the last one alone.
  ASSERT_EQ(ours.write(kMachineWord, 1), Status::Ok);
  const broker::Node reader = third.ring().observe();
  ASSERT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 1; }));
  auto follower = third.ring().follow("machine");
  broker::Node theirs = there_.ring().join("machine", 0);
  there_.start(relay_->connect());
  ASSERT_TRUE(comes_true([&] {
    const auto lines = here_.lines();
    return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
      return line.find("node 'machine' of host 'there' is refused") == 0;
    });
  }));

  constexpr std::uint32_t kWrites = 20'000;
  const WallClock clock;
  for (std::uint32_t i = 2; i <= kWrites; ++i) {
    const TimePoint next = clock.now() + std::chrono::microseconds{40};
    ASSERT_EQ(ours.write(kMachineWord, i), Status::Ok);
    while (clock.now() < next) continue;  // a sleep is longer than the join that is refused
  }

  std::uint32_t last = 1, missing = 0;
  broker::Write write{};
  ASSERT_TRUE(comes_true([&] {
    while (follower.next(write) == Followed::Write) {
      if (write.offset != kMachineWord) continue;
      missing += write.value - last - 1;
      last = write.value;
    }
    return last == kWrites;
  }));
  EXPECT_EQ(missing, 0U) << here_.gateway().counts().lapped << " lapped, "
                         << third.gateway().counts().snapshots << " snapshots, "
                         << third.gateway().counts().gaps << " gaps";
}

TEST_F(GatewayTest, NamesAHostWithAnotherMap) {
  RingHost other{"other", test::small_map(4)};
  here_.start(relay_->connect());
  other.start(relay_->connect());
  EXPECT_TRUE(comes_true([&] {
    const auto lines = here_.lines();
    return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
      return line.find("host 'other' has another map: its hash is ") == 0;
    });
  }));
  EXPECT_GT(here_.gateway().counts().bad_frames, 0U);
}

TEST_F(GatewayTest, SurvivesGarbageOfAHostileParticipant) {
  start();
  broker::Node machine = here_.ring().join("machine", 0);
  ASSERT_EQ(machine.write(kMachineWord, 5), Status::Ok);
  const broker::Node reader = there_.ring().observe();
  ASSERT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 5; }));
  std::mt19937_64 random{3};
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> bytes(random() % 300);
    for (auto& byte : bytes) byte = static_cast<std::byte>(random());
    relay_->inject(bytes);
  }
  EXPECT_TRUE(comes_true([&] { return there_.gateway().counts().bad_frames >= 2000; }));
  ASSERT_EQ(machine.write(kMachineWord, 6), Status::Ok);
  EXPECT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 6; }));
}

// Words that a program stored past the API reach no journal; the digests of the two images differ.
TEST_F(GatewayTest, RepairsAnImageThatDiffers) {
  start();
  broker::Node machine = here_.ring().join("machine", 0);
  ASSERT_EQ(machine.write(kMachineWord, 21), Status::Ok);
  const broker::Node reader = there_.ring().observe();
  ASSERT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 21; }));
  // The other host's copy is damaged as by a stray store.
  {
    test::overwrite_word(there_.ring_name(), kMachineWord, 99);
    ASSERT_EQ(reader.read(kMachineWord), 99U);
  }
  EXPECT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 21; }));
  EXPECT_GE(there_.gateway().counts().mismatches, 1U);
}

TEST_F(GatewayTest, ConvergesAfterItWasCutOff) {
  start();
  broker::Node machine = here_.ring().join("machine", 0);
  ASSERT_EQ(machine.write(kMachineWord, 1), Status::Ok);
  const broker::Node reader = there_.ring().observe();
  ASSERT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 1; }));
  relay_->cut(1, true);
  for (std::uint32_t i = 2; i <= 500; ++i) {
    ASSERT_EQ(machine.write(kMachineWord, i), Status::Ok);
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
  EXPECT_EQ(reader.read(kMachineWord), 1U);
  relay_->cut(1, false);
  EXPECT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 500; }));
}

TEST_F(GatewayTest, GoesOnAfterARestartOfEitherSide) {
  start();
  broker::Node machine = here_.ring().join("machine", 0);
  const broker::Node reader = there_.ring().observe();
  for (std::uint32_t round = 1; round <= 3; ++round) {
    RingHost& restarted = round % 2 == 0 ? here_ : there_;
    restarted.stop();
    ASSERT_EQ(machine.write(kMachineWord, 10 * round), Status::Ok);
    restarted.start(relay_->connect());
    EXPECT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 10 * round; })) << round;
    ASSERT_EQ(machine.write(kMachineWord, 10 * round + 1), Status::Ok);
    EXPECT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 10 * round + 1; })) << round;
  }
}

TEST_F(GatewayTest, KnowsTheClocksOfOtherHostsAndTheAgesOfTheirWords) {
  start();
  const broker::Node machine = here_.ring().join("machine", 0);
  const auto age = [&] {
    const auto nodes = there_.gateway().status().nodes;
    return nodes.empty() ? 1e9 : to_seconds(nodes[0].age);
  };
  ASSERT_TRUE(comes_true([&] { return age() < 0.2; }));
  const auto status = there_.gateway().status();
  EXPECT_EQ(status.nodes[0].node, "machine");
  EXPECT_EQ(status.nodes[0].host, "here");
  ASSERT_TRUE(status.hosts.at(0).clock.has_value());
  // Both are on this computer's clock.
  EXPECT_LE(std::chrono::abs(status.hosts[0].clock->offset), status.hosts[0].clock->error);
  EXPECT_LT(std::chrono::abs(status.hosts[0].real_time_ahead), std::chrono::seconds{1});

  relay_->cut(0, true);
  EXPECT_TRUE(comes_true([&] { return age() > 0.5; }));
  relay_->cut(0, false);
  EXPECT_TRUE(comes_true([&] { return age() < 0.2; }));
}

// Damaged datagrams with a valid checksum can spoil DDS's records of another host for good.
TEST_F(GatewayTest, JoinsTheNetworkAnewIfAHostIsSilentThatIsThere) {
  for (const auto way : {test::Relay::Way::In, test::Relay::Way::Out}) {
    start();
    const broker::Node reader = there_.ring().observe();
    broker::Node machine = here_.ring().join("machine", 0);
    ASSERT_EQ(machine.write(kMachineWord, 1), Status::Ok);
    ASSERT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 1; }));
    // The receiver is deaf, or the sender is mute.
    const std::size_t spoilt = way == test::Relay::Way::In ? 1 : 0;
    relay_->spoil(relay_->counts().carriers - 2 + spoilt, way);

    for (std::uint32_t i = 2; i <= 1000; ++i) ASSERT_EQ(machine.write(kMachineWord, i), Status::Ok);

    EXPECT_TRUE(comes_true([&] { return reader.read(kMachineWord) == 1000; }));
    EXPECT_EQ(there_.gateway().counts().snapshots, 1U) << "no update is lost";
    auto& gateway = spoilt == 1 ? there_.gateway() : here_.gateway();
    EXPECT_GE(gateway.counts().rejoins, 1U);
    const auto lines = spoilt == 1 ? there_.lines() : here_.lines();
    EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                            [](const auto& line) {
                              return line.find("joins the network anew") != std::string::npos;
                            }),
              1);
    here_.stop();
    there_.stop();
  }
}

TEST_F(GatewayTest, StaysInTheNetworkIfAHostIsGone) {
  start();
  const auto knows = [](RingHost& host) { return host.gateway().status().hosts.size() == 1; };
  ASSERT_TRUE(comes_true([&] { return knows(here_) && knows(there_); }));
  relay_->cut(1, true);
  std::this_thread::sleep_for(std::chrono::milliseconds{4500});
  EXPECT_EQ(here_.gateway().counts().rejoins, 0U);
  EXPECT_EQ(there_.gateway().counts().rejoins, 0U);
}

/// A host that only announces itself, with a calendar clock of its own.
class Stranger {
 public:
  Stranger(std::unique_ptr<dds::Carrier> carrier, std::uint64_t map_hash, Duration ahead)
      : carrier_{std::move(carrier)}, map_hash_{map_hash}, ahead_{ahead} {
    carrier_->listen([this](std::span<const std::byte> bytes) { answer(bytes); });
  }
  ~Stranger() { carrier_->listen({}); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

 private:
  void answer(std::span<const std::byte> bytes) {
    dds::FrameDefect defect{};
    const auto frame = dds::decode(bytes, defect);
    if (!frame || frame->header.kind != dds::FrameKind::Hello) return;
    const TimePoint now = WallClock{}.now();
    dds::FrameHeader header;
    header.host = 77;
    header.map_hash = map_hash_;
    header.sent = now.count();
    dds::FrameWriter writer{header};
    dds::Hello hello;
    hello.host = "stranger";
    hello.real_time = dds::real_time_offset() + ahead_;
    hello.echoes = {{frame->header.host, TimePoint{frame->header.sent}, now}};
    writer.add_bytes(dds::to_bytes(hello));
    static_cast<void>(carrier_->send(writer.finish()));
  }
  std::unique_ptr<dds::Carrier> carrier_;
  std::uint64_t map_hash_;
  Duration ahead_;
};

TEST_F(GatewayTest, NamesAHostWhoseCalendarIsAnHourOff) {
  here_.start(relay_->connect());
  const Stranger stranger{relay_->connect(), map_.hash(), -std::chrono::hours{1}};
  const auto complaints = [&] {
    const auto lines = here_.lines();
    return std::count(lines.begin(), lines.end(),
                      "the clock of host 'stranger' is 3600.0 s behind ours; its times are "
                      "corrected");
  };
  EXPECT_TRUE(comes_true([&] { return complaints() == 1; }));
  std::this_thread::sleep_for(std::chrono::milliseconds{200});
  EXPECT_EQ(complaints(), 1) << "said once";
}

memmap::Map two_policies() {
  return memmap::parse_map(R"(ringmap = 1
[ring]
name = "policies"
version = 1
size_bytes = 4096
[nodes]
machine = 1
gateway_there = 2
[[partition]]
name = "every"
node = "machine"
offset = 0
longwords = 1
[[partition]]
name = "latest"
node = "machine"
offset = 16
longwords = 1
replication = "latest"
[[partition]]
name = "group"
node = "machine"
offset = 32
longwords = 3
tear_group = true
replication = "latest"
[[partition]]
name = "gateway.there"
node = "gateway_there"
offset = 64
longwords = 2
[[partition.signal]]
name = "age.machine"
offset = 64
type = "f32"
unit = "ms"
[[partition.signal]]
name = "clock_error.here"
offset = 65
type = "f32"
unit = "ms"
)",
                           "policies");
}

/// Two hosts with partitions of both policies.
class Policies : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kWrites = 20'000;
  std::shared_ptr<test::Relay> relay_ = std::make_shared<test::Relay>(1);
  RingHost here_{"here", two_policies()}, there_{"there", two_policies()};

  /// Writes to all partitions. @returns writes that arrive on the other host, by first longword
  std::map<std::uint32_t, std::uint32_t> arrivals(const dds::GatewayOptions& options,
                                                  std::uint32_t step) {
    here_.start(relay_->connect(), options);
    there_.start(relay_->connect(), options);
    auto follower = there_.ring().follow("machine");
    broker::Node machine = here_.ring().join("machine", 0);
    const broker::Node reader = there_.ring().observe();
    EXPECT_TRUE(comes_true([&] { return there_.gateway().counts().snapshots > 0; }));
    const auto group = here_.ring().tear_group("group");
    std::map<std::uint32_t, std::uint32_t> counts;
    const auto count = [&] {
      for (broker::Write write{}; follower.next(write) == Followed::Write;) {
        const bool is_whole = write.offset.value() != 32 ||
                              (write.group.size() == 3 && write.group[0] == write.group[2]);
        EXPECT_TRUE(is_whole);
        ++counts[write.offset.value()];
      }
    };
    count();
    counts.clear();
    for (std::uint32_t i = 1; i <= kWrites; ++i) {
      const std::uint32_t value = i / step;
      EXPECT_EQ(machine.write(LongwordOffset{0}, value), Status::Ok);
      EXPECT_EQ(machine.write(LongwordOffset{16}, value), Status::Ok);
      EXPECT_EQ(machine.write_group(group, std::array{value, value, value}), Status::Ok);
      if (i % 1000 != 0) continue;
      // Keeps the follower within one journal.
      EXPECT_TRUE(comes_true([&] {
        count();
        return reader.read(LongwordOffset{0}) + 2000 / step > value;
      }));
    }
    std::vector<std::uint32_t> words(3);
    EXPECT_TRUE(comes_true([&] {
      count();
      return reader.read(LongwordOffset{0}) == kWrites / step &&
             reader.read(LongwordOffset{16}) == kWrites / step &&
             reader.read_group(group, words) == Status::Ok && words[2] == kWrites / step;
    }));
    std::this_thread::sleep_for(std::chrono::milliseconds{50});
    count();
    return counts;
  }
};

TEST_F(Policies, SendEveryWriteOrOnlyTheNewestValues) {
  auto counts = arrivals({}, 1);
  EXPECT_EQ(counts[0], kWrites);
  EXPECT_LT(counts[16], kWrites / 10);
  EXPECT_GE(counts[16], 1U);
  EXPECT_LT(counts[32], kWrites / 10);
  EXPECT_GE(counts[32], 1U);
}

TEST_F(Policies, AreIgnoredInVirtualTime) {
  dds::GatewayOptions options;
  options.is_deterministic = true;
  auto counts = arrivals(options, 1);
  EXPECT_EQ(counts[0], kWrites);
  EXPECT_EQ(counts[16], kWrites);
  EXPECT_EQ(counts[32], kWrites);
}

TEST_F(Policies, CanLeaveOutWritesThatChangeNothing) {
  dds::GatewayOptions options;
  options.skips_unchanged = true;
  EXPECT_LE(arrivals(options, 100)[0], kWrites / 100 + 1);
}

TEST_F(Policies, HaveSignalsOfTheirGateway) {
  here_.start(relay_->connect());
  there_.start(relay_->connect());
  const broker::Node machine = here_.ring().join("machine", 0);
  const broker::Node reader = there_.ring().observe(), far = here_.ring().observe();
  const auto value = [](const broker::Node& node, std::uint32_t offset) {
    return std::bit_cast<float>(node.read(LongwordOffset{offset}));
  };
  for (const auto* node : {&reader, &far}) {
    EXPECT_TRUE(comes_true([&] { return value(*node, 64) > 0 && value(*node, 64) < 200; }));
    EXPECT_TRUE(comes_true([&] { return value(*node, 65) > 0 && value(*node, 65) < 100; }));
  }
}

/// Reads every write of a node and checks that tagged values arrive once and in order.
struct Check {
  broker::Follower follower;
  std::uint32_t next = 1;
  std::uint64_t wrong = 0, torn = 0, journal_lost = 0;

  void read() {
    broker::Write write{};
    for (;;) {
      const Followed followed = follower.next(write);
      if (followed == Followed::Nothing) return;
      if (followed == Followed::Lost) ++journal_lost;
      if (followed != Followed::Write) continue;
      if (write.offset.value() % 100 == 64) continue;  // newest values only
      const std::uint32_t tag = write.group.empty() ? write.value : write.group[0];
      for (const std::uint32_t word : write.group) torn += word != tag ? 1 : 0;
      if (tag + 1 == next || tag == 0) continue;  // of the snapshot at the start
      wrong += tag == next ? 0 : 1;
      next = tag + 1;
    }
  }
};

// Each of three hosts has one writer; every host reads the other two.
TEST(Gateways, LoseNothingAndKeepOrderUnderFaults) {
  const auto writes =
      static_cast<std::uint32_t>(test::Repetitions{10'000'000, 100'000, 20'000}.count());
  constexpr std::uint64_t kSeed = 20261123;
  memmap::MapDescription description;
  description.name = "three";
  description.size_longwords = 1024;
  for (std::uint16_t i = 0; i < 3; ++i) {
    const std::string node = "n" + std::to_string(i);
    description.nodes.push_back({node, NodeId{static_cast<std::uint16_t>(i + 1)}, ""});
    memmap::Partition word, group, latest;
    word.name = "word" + std::to_string(i);
    group.name = "group" + std::to_string(i);
    latest.name = "latest" + std::to_string(i);
    word.node = group.node = latest.node = node;
    latest.base = LongwordOffset{100U * i + 64};
    latest.longwords = 1;
    latest.latest = true;
    word.base = LongwordOffset{100U * i};
    word.longwords = 1;
    group.base = LongwordOffset{100U * i + 32};
    group.longwords = 20;
    group.tear_group = true;
    description.partitions.push_back(word);
    description.partitions.push_back(group);
    description.partitions.push_back(latest);
  }
  const memmap::Map map{description};
  const auto relay = std::make_shared<test::Relay>(
      kSeed, test::RelayFaults{0.05, 0.01, 0.02, std::chrono::milliseconds{20}});
  std::vector<std::unique_ptr<RingHost>> hosts;
  std::vector<broker::Node> writers;
  for (std::size_t i = 0; i < 3; ++i) {
    hosts.push_back(std::make_unique<RingHost>("h" + std::to_string(i), map));
    writers.push_back(hosts[i]->ring().join("n" + std::to_string(i), 0));
    hosts[i]->start(relay->connect());
  }
  std::vector<Check> checks;
  for (auto& host : hosts)
    for (std::size_t node = 0; node < 3; ++node) {
      ASSERT_TRUE(comes_true([&] {
        const auto reader = host->ring().observe();
        return reader.presence_of(map.node("n" + std::to_string(node))).state ==
                   Presence::State::Alive &&
               (host == hosts[node] || host->gateway().counts().snapshots >= 2);
      }));
      if (host != hosts[node]) checks.push_back({host->ring().follow("n" + std::to_string(node))});
    }
  // Every tenth write is a group. Pauses keep the checks within one journal.
  std::vector<std::uint32_t> group(20);
  for (std::uint32_t tag = 1; tag <= writes; ++tag) {
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(writers[i].write(LongwordOffset{static_cast<std::uint32_t>(100 * i + 64)}, tag),
                Status::Ok);
      if (tag % 10 != 0) {
        ASSERT_EQ(writers[i].write(LongwordOffset{static_cast<std::uint32_t>(100 * i)}, tag),
                  Status::Ok);
        continue;
      }
      std::fill(group.begin(), group.end(), tag);
      ASSERT_EQ(
          writers[i].write_group(hosts[i]->ring().tear_group("group" + std::to_string(i)), group),
          Status::Ok);
    }
    if (tag % 500 == 0) {
      for (auto& check : checks) check.read();
      std::this_thread::sleep_for(std::chrono::milliseconds{2});
      const auto behind = [&] {
        for (auto& check : checks) check.read();
        return std::all_of(checks.begin(), checks.end(),
                           [&](const Check& check) { return check.next + 5'000 > tag; });
      };
      ASSERT_TRUE(comes_true(behind, std::chrono::seconds{60})) << tag;
    }
  }
  ASSERT_TRUE(comes_true(
      [&] {
        for (auto& check : checks) check.read();
        return std::all_of(checks.begin(), checks.end(),
                           [&](const Check& check) { return check.next == writes + 1; });
      },
      std::chrono::seconds{60}));
  for (const auto& check : checks) {
    EXPECT_EQ(check.wrong, 0U);
    EXPECT_EQ(check.torn, 0U);
    EXPECT_EQ(check.journal_lost, 0U);
  }
  for (auto& host : hosts)
    for (const std::uint32_t offset : {64U, 164U, 264U})
      ASSERT_TRUE(comes_true([&, reader = host->ring().observe()] {
        return reader.read(LongwordOffset{offset}) == writes;
      })) << offset;
  for (std::uint32_t offset = 0; offset < 1024; ++offset)
    for (auto& host : hosts)
      ASSERT_EQ(host->ring().observe().read(LongwordOffset{offset}),
                hosts[0]->ring().observe().read(LongwordOffset{offset}))
          << offset;
  const auto counts = relay->counts();
  EXPECT_GT(counts.lost, 0U);
  EXPECT_GT(counts.delayed, 0U);
  std::printf(
      "seed %llu: %llu frames passed, %llu lost, %llu delayed, %llu duplicated\n",
      static_cast<unsigned long long>(kSeed), static_cast<unsigned long long>(counts.passed),
      static_cast<unsigned long long>(counts.lost), static_cast<unsigned long long>(counts.delayed),
      static_cast<unsigned long long>(counts.duplicated));
  for (auto& host : hosts) {
    const auto c = host->gateway().counts();
    std::printf(
        "  sent %llu, received %llu updates, %llu missing, %llu repeated, %llu frames again\n",
        static_cast<unsigned long long>(c.updates_sent),
        static_cast<unsigned long long>(c.updates_received),
        static_cast<unsigned long long>(c.gaps), static_cast<unsigned long long>(c.repeated),
        static_cast<unsigned long long>(c.sent_again));
    EXPECT_EQ(c.lapped, 0U);
  }
}

}  // namespace
}  // namespace rths
