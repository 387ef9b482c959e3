// SPDX-License-Identifier: Apache-2.0
//
// Unchanged programs of the vendor's API on a replicated ring: each has its own image and card.
#include <optional>

#include <gtest/gtest.h>

#include <rths/card/shared_cards.hpp>

#include "support/carried_images.hpp"
#include "support/long_run.hpp"
#include "vendor_ring.hpp"

namespace {

using rths::LongwordOffset;
using rths::NodeId;
using rths::test::Finished;
using rths::test::Running;

constexpr std::uint32_t kPartition = 1024;  // of the handshake [longwords]

rths::memmap::Partition partition_of(const std::string& node, std::uint32_t base,
                                     std::uint32_t longwords,
                                     const std::vector<std::uint32_t>& flags = {}) {
  rths::memmap::Partition partition;
  partition.name = node + std::to_string(base);
  partition.node = node;
  partition.base = LongwordOffset{base};
  partition.longwords = longwords;
  for (const std::uint32_t offset : flags) {
    rths::memmap::Signal signal;
    signal.name = "flag_" + std::to_string(offset);
    signal.unit = "1";
    signal.event = true;
    signal.offset = LongwordOffset{offset};
    partition.signals.push_back(signal);
  }
  return partition;
}

rths::memmap::Map map_of(const std::vector<rths::memmap::Partition>& partitions) {
  rths::memmap::MapDescription description;
  description.name = "clients";
  description.size_longwords = 2048;
  description.nodes = {{"solver", NodeId{1}, ""}, {"controller", NodeId{2}, ""}};
  description.partitions = partitions;
  return rths::memmap::Map{description};
}

/// Words of OpenFresco's handshake: newTarget and four commands; switchPC, atTarget, four
/// feedbacks.
rths::memmap::Map handshake_map() {
  return map_of({partition_of("solver", kPartition, 5, {kPartition}),
                 partition_of("controller", kPartition + 5, 6, {kPartition + 5, kPartition + 6})});
}

/// Two words of the solver that interrupt, and one by which the controller is ready.
rths::memmap::Map interrupt_map() {
  return map_of({partition_of("solver", 0, 2), partition_of("controller", kPartition, 1)});
}

/// A replicated ring of vendor clients.
class ReplicatedClients : public rths::test::VendorRing {
 protected:
  void begin(const rths::memmap::Map& map) {
    use(name());
    images_.emplace(name(), map);
  }
  void TearDown() override {
    images_.reset();
    use(ring());
  }
  static std::string name() { return ring() + "_images"; }
  static std::vector<std::string> at_node(const std::string& node, std::vector<std::string> run) {
    run.insert(run.begin(), {"/usr/bin/env", "RTHS_SCRAMNET_NODE=" + node});
    return run;
  }
  /// Waits until a program has written CSR0. A store does not reach a card that joins later.
  static bool is_on_ring(const std::string& node, unsigned csr0) {
    for (int i = 0; i < 10'000; ++i, usleep(1000))
      for (const auto& card : rths::scramnet::cards_of(rths::replicated::image_name(name(), node)))
        if (card.csr[0] == csr0) return true;
    return false;
  }
  /// Waits until a word of a node's own image is not zero.
  static bool has_stored(const std::string& node, LongwordOffset offset) {
    rths::broker::Ring image =
        rths::broker::Ring::attach(rths::replicated::image_name(name(), node));
    const rths::broker::Node observer = image.observe();
    for (int i = 0; i < 10'000; ++i, usleep(1000))
      if (observer.read(offset) != 0) return true;
    return false;
  }
  [[nodiscard]] std::unique_lock<std::mutex> pause() { return images_->pause(); }

 private:
  std::optional<rths::test::CarriedImages> images_;
};

TEST_F(ReplicatedClients, CompleteOpenFrescosHandshakeWithoutALostFlag) {
  begin(handshake_map());
  const std::string steps = rths::test::is_long() ? "10000" : "100";
  Running solver{at_node("solver", client("openfresco", {steps}))};
  ASSERT_TRUE(is_on_ring("solver", 0x8003));
  Running controller{at_node("controller", client("controller"))};

  const Finished of_solver = solver.wait(rths::test::is_long() ? 600 : 110);
  const Finished of_controller = controller.wait(5);

  EXPECT_EQ(of_solver.exit_code, 0) << of_solver.err;
  EXPECT_EQ(of_controller.exit_code, 0) << of_controller.err;
  EXPECT_EQ(of_solver.out, steps + " steps\n");
  EXPECT_EQ(of_controller.out, steps + " steps\n");
}

/// A node counts the interrupts of another one.
class ReplicatedInterrupts : public ReplicatedClients {
 protected:
  /// @param traps  of the program that stores
  /// @param pauses  no message is carried from the first store until the program has left
  int count(const std::string& how, const std::string& traps = "1", bool pauses = false) {
    begin(interrupt_map());
    auto write = at_node("solver", client("ticks", {"write", "100", "500"}));
    write.insert(write.begin() + 1, "RTHS_SCRAMNET_TRAPS=" + traps);
    Running writer{write};
    EXPECT_TRUE(is_on_ring("solver", 0x8103));  // before the counter says once that it is ready
    Running counter{at_node("controller", client("ticks", {how}))};

    std::unique_lock<std::mutex> paused;
    if (pauses) {
      EXPECT_TRUE(has_stored("solver", LongwordOffset{0}));
      paused = pause();
    }
    EXPECT_EQ(writer.wait(30).exit_code, 0);
    if (pauses) paused.unlock();
    const Finished counted = counter.wait(30);  // by the interrupt of the last word
    EXPECT_EQ(counted.exit_code, 0) << counted.err;
    return std::atoi(counted.out.c_str());
  }
};

#if defined(__x86_64__)
constexpr int kFewest = 100;
#else
constexpr int kFewest = 1;  // by scans
#endif

TEST_F(ReplicatedInterrupts, ReachAWaitingHost) {
  const int counted = count("wait");
  EXPECT_GE(counted, kFewest);
  EXPECT_LE(counted, 100);
}

TEST_F(ReplicatedInterrupts, ReachARegisteredHostBySignals) {
  const int counted = count("signal");
  EXPECT_GE(counted, kFewest);
  EXPECT_LE(counted, 100);
}

// The last stores keep their order and their number although their program has left.
TEST_F(ReplicatedInterrupts, ReachAHostAfterTheirProgramHasLeft) {
  const int counted = count("wait", "1", true);
  EXPECT_GE(counted, kFewest);
  EXPECT_LE(counted, 100);
}

TEST_F(ReplicatedInterrupts, AreFoundByScansWithoutTraps) {
  const int counted = count("wait", "0");
  EXPECT_GE(counted, 1);
  EXPECT_LE(counted, 100);
}

/// Three nodes with a few words each, in a memory of 1 MiB.
rths::memmap::Map map_of_three() {
  rths::memmap::MapDescription description;
  description.name = "three";
  description.size_longwords = 0x40000;
  description.nodes = {{"a", NodeId{1}, ""}, {"b", NodeId{2}, ""}, {"c", NodeId{3}, ""}};
  description.partitions = {partition_of("a", 0, 4), partition_of("b", 4, 4),
                            partition_of("c", 0x3000, 2048)};
  return rths::memmap::Map{description};
}

#if defined(__x86_64__)
// Every member stores into the words of all others, and into words without an owner.
TEST_F(ReplicatedClients, StoreAllOverTheMemory) {
  begin(map_of_three());
  const std::string seconds = rths::test::is_long() ? "60" : "3";
  std::vector<std::unique_ptr<Running>> members;
  for (const auto& [node, number] : {std::pair{"a", "1"}, {"b", "2"}, {"c", "3"}})
    members.push_back(
        std::make_unique<Running>(at_node(node, client("network_exerciser", {number, seconds}))));
  for (const auto& member : members) {
    const Finished finished = member->wait(rths::test::is_long() ? 180 : 60);
    EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
    EXPECT_NE(finished.out.find(" 2 others, 0 errors, 0 link errors"), std::string::npos)
        << finished.out;
  }
}

TEST_F(ReplicatedClients, LoadWhatHasGoneAroundTheRing) {
  begin(map_of_three());
  for (const char* how : {"blocks", "pointer"}) {
    const Finished finished = Running{at_node("b", client("bit_errors", {"50", how}))}.wait(60);
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    EXPECT_EQ(finished.out, "50 packets, 0 words wrong, 0 words old, 0 link errors\n") << how;
  }
}
#endif

TEST_F(ReplicatedClients, MustNameTheirNode) {
  begin(handshake_map());
  const Finished finished = Running{client("controller")}.wait(10);

  EXPECT_NE(finished.exit_code, 0);
  EXPECT_NE(finished.err.find("RTHS_SCRAMNET_NODE is '', expected a node of its map"),
            std::string::npos)
      << finished.err;
}

}  // namespace
