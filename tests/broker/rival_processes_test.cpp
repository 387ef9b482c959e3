// SPDX-License-Identifier: Apache-2.0
//
// Processes that are copies of each other, or that replace the same ring at the same time.
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <rths/broker/ring.hpp>

#include "broker/src/segment.hpp"
#include "support/files.hpp"
#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using test::RingRemoval;
using test::small_map;
using test::unique_ring;

/// Nodes on the ring and their processes.
std::vector<std::pair<std::string, int>> occupants_of(const std::string& name) {
  std::vector<std::pair<std::string, int>> occupants;
  const auto report = inspect_ring(name);
  if (!report) return occupants;
  for (const auto& occupant : report->occupants)
    if (occupant.alive) occupants.emplace_back(occupant.node, occupant.pid);
  return occupants;
}

TEST(RivalProcesses, AForkedChildThatExitsLeavesItsParentOnTheRing) {
  const std::string name = unique_ring("forked");
  const RingRemoval removal{name};
  static std::optional<Ring> ring;  // destroyed by exit()
  static std::optional<Node> machine;
  ring.emplace(Ring::create(name, small_map()));
  machine.emplace(ring->join("machine", 0));
  std::fflush(nullptr);

  const pid_t child = fork();
  if (child == 0) std::exit(0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);

  const std::vector<std::pair<std::string, int>> both{{"creator", getpid()}, {"machine", getpid()}};
  EXPECT_EQ(occupants_of(name), both);
  machine.reset();
  EXPECT_EQ(occupants_of(name).size(), 1U);
  ring.reset();
  EXPECT_TRUE(occupants_of(name).empty());
}

// Others take a process for dead if they cannot see it, for example from another container.
TEST(RivalProcesses, ANodeThatWasTakenForDeadDoesNotFreeTheSlotOfItsSuccessor) {
  const std::string name = unique_ring("taken");
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map());
  const auto segment = Segment::attach_shared(name);
  std::optional machine{ring.join("machine", 0)};
  Slot& slot = *segment->slot_of(NodeId{1});
  const Claim successor = own_claim() + 1;
  slot.claim = successor;

  machine.reset();

  EXPECT_EQ(slot.claim, successor);
  EXPECT_EQ(slot.node, 1U);
}

TEST(RivalProcesses, OnlyOneOfThemReplacesARing) {
  const std::string name = unique_ring("replaced");
  const RingRemoval removal{name};
  { const Ring abandoned = Ring::create(name, small_map()); }
  auto first = SharedObject::open_to_remove(name);
  ASSERT_TRUE(first);

  EXPECT_FALSE(SharedObject::open_to_remove(name));
  EXPECT_EQ(test::error_of([&] { static_cast<void>(Ring::create(name, small_map())); }),
            "another process is using or replacing ring '" + name + "'; choose another name");

  first.reset();
  EXPECT_EQ(test::error_of([&] { static_cast<void>(Ring::create(name, small_map())); }), "");
}

TEST(RivalProcesses, ARingThatHasBeenReplacedIsNotTheOneThatWasInspected) {
  const std::string name = unique_ring("inspected");
  const RingRemoval removal{name};
  { const Ring abandoned = Ring::create(name, small_map()); }
  const auto inspected = SharedObject::open_to_remove(name);
  ASSERT_TRUE(inspected && inspected->has_name(name));

  remove_ring(name);
  EXPECT_FALSE(inspected->has_name(name));
  const Ring other = Ring::create(name, small_map());

  EXPECT_FALSE(inspected->has_name(name));
}

}  // namespace
}  // namespace rths::broker
