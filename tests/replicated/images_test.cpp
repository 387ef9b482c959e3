// SPDX-License-Identifier: Apache-2.0
//
// One memory image per node, between which cards carry the writes.
#include <array>
#include <future>
#include <vector>

#include <gtest/gtest.h>

#include <rths/broker/follow.hpp>
#include <rths/core/error.hpp>
#include <rths/replicated/images.hpp>

#include "support/ring_maps.hpp"

namespace rths::replicated {
namespace {

constexpr std::uint32_t kGroup = 8;
constexpr Time kLongAfter = std::chrono::microseconds{100};
// A message of 82 bits at 150 Mbit/s and 10 m of fibre, rounded up to a nanosecond.
constexpr double kOneNodeOn_ns = 597;

/// A machine and a controller, each with its image.
class ReplicatedImages : public testing::Test {
 protected:
  void begin(const CardOptions& options = {}) {
    machine.reset();
    controller.reset();
    images.emplace(Images::in_process(test::small_map(kGroup), options));
    machine.emplace(images->of("machine").join("machine", 0));
    controller.emplace(images->of("controller").join("controller", 0));
    images->advance(Time{0});
  }
  std::uint32_t seen_by_controller() { return controller->read(test::kMachineWord); }

  std::optional<Images> images;
  std::optional<broker::Node> machine, controller;
};

Fault fault_at(double seconds, const std::string& node, Action::Kind kind) {
  Fault fault;
  fault.node = node;
  fault.action.kind = kind;
  fault.action.at = from_ns(seconds * 1e9);
  return fault;
}

TEST_F(ReplicatedImages, ShowAWriteWhenItsMessageHasArrived) {
  begin();
  ASSERT_EQ(machine->write(test::kMachineWord, 7), Status::Ok);
  images->advance(Time{0});

  images->advance(from_ns(kOneNodeOn_ns - 1));
  EXPECT_EQ(seen_by_controller(), 0U);
  EXPECT_EQ(machine->read(test::kMachineWord), 7U);
  images->advance(from_ns(kOneNodeOn_ns));
  EXPECT_EQ(seen_by_controller(), 7U);
}

TEST_F(ReplicatedImages, ShowTheWritesOfANodeEachOnceAndInOrder) {
  begin();
  auto follower = images->of("controller").follow("machine");
  for (std::uint32_t value = 1; value <= 300; ++value)
    ASSERT_EQ(machine->write(test::kMachineWord, value), Status::Ok);
  images->advance(Time{0});
  images->advance(std::chrono::milliseconds{1});

  std::vector<std::uint32_t> values;
  for (broker::Write write; follower.next(write) == broker::Followed::Write;)
    values.push_back(write.value);
  ASSERT_EQ(values.size(), 300U);
  for (std::uint32_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], i + 1);
}

TEST_F(ReplicatedImages, KeepWritesThatFindTheTransmitFifoFull) {
  begin();
  for (std::uint32_t value = 1; value <= 3000; ++value)
    ASSERT_EQ(machine->write(test::kMachineWord, value), Status::Ok);
  for (int i = 0; i <= 20; ++i) images->advance(std::chrono::microseconds{100 * i});

  EXPECT_GT(images->stalls(), 0U);
  EXPECT_EQ(seen_by_controller(), 3000U);
}

TEST_F(ReplicatedImages, ChangeATearGroupWhenItsLastWordHasArrived) {
  begin();
  const auto group = images->of("controller").tear_group("fbk");
  std::array<std::uint32_t, kGroup> words{1, 2, 3, 4, 5, 6, 7, 8}, read{};
  ASSERT_EQ(machine->write_group(images->of("machine").tear_group("fbk"), words), Status::Ok);
  images->advance(Time{0});

  images->advance(from_ns(7 * kOneNodeOn_ns));
  ASSERT_EQ(controller->read_group(group, read), Status::Ok);
  EXPECT_EQ(read, (std::array<std::uint32_t, kGroup>{}));
  images->advance(kLongAfter);
  ASSERT_EQ(controller->read_group(group, read), Status::Ok);
  EXPECT_EQ(read, words);
}

TEST_F(ReplicatedImages, CutOffANodeThatIsOutOfTheRing) {
  CardOptions options;
  options.faults = {fault_at(20e-6, "machine", Action::Kind::PowerOff)};
  begin(options);
  ASSERT_EQ(machine->write(test::kMachineWord, 1), Status::Ok);
  images->advance(Time{0});
  images->advance(from_ns(30e3));
  const std::uint64_t beats = controller->beats_of(NodeId{1});

  ASSERT_EQ(machine->write(test::kMachineWord, 2), Status::Ok);
  images->advance(from_ns(30e3));
  images->advance(kLongAfter);

  EXPECT_EQ(seen_by_controller(), 1U);
  EXPECT_EQ(beats, 1U);
  EXPECT_EQ(controller->beats_of(NodeId{1}), beats);
  EXPECT_EQ(images->events(), (std::vector<std::string>{"machine out of the ring at 0.000 s"}));
}

/// A value that arrives at the controller if the machine writes 9 some time after these faults.
class FaultyImages : public ReplicatedImages {
 protected:
  std::uint32_t seen_after(const std::vector<Fault>& faults, CardOptions options = {}) {
    options.faults = faults;
    begin(options);
    images->advance(kLongAfter);
    EXPECT_EQ(machine->write(test::kMachineWord, 9), Status::Ok);
    images->advance(kLongAfter);
    images->advance(2 * kLongAfter);
    return seen_by_controller();
  }
};

TEST_F(FaultyImages, PassNothingOverACutFibreUntilItIsRepaired) {
  const Fault cut = fault_at(10e-6, "machine", Action::Kind::CutFibre);
  EXPECT_EQ(seen_after({cut}), 0U);
  EXPECT_EQ(seen_after({cut, fault_at(20e-6, "machine", Action::Kind::RepairFibre)}), 9U);
}

TEST_F(FaultyImages, RejectMessagesWithBitErrors) {
  Fault errors = fault_at(10e-6, "", Action::Kind::BitErrorRate);
  errors.action.rate = 1;
  EXPECT_EQ(seen_after({errors}), 0U);
}

TEST_F(FaultyImages, SwallowMessagesOfTheirOwnIdInStrictMode) {
  Fault same = fault_at(10e-6, "controller", Action::Kind::Id);
  same.action.value = 1;  // the machine's
  EXPECT_EQ(seen_after({same}), 9U);
  CardOptions strict;
  strict.strict_ids = true;
  EXPECT_EQ(seen_after({same}, strict), 0U);
}

TEST_F(ReplicatedImages, CountFaultsFromTheBeginning) {
  CardOptions options;
  options.faults = {fault_at(0.5, "machine", Action::Kind::CutFibre)};
  begin(options);
  images->begin(std::chrono::seconds{2});

  images->advance(from_ns(2.4e9));
  EXPECT_TRUE(images->events().empty());
  images->advance(from_ns(2.6e9));
  EXPECT_EQ(images->events(), (std::vector<std::string>{"fibre cut behind machine at 0.500 s"}));
}

TEST_F(ReplicatedImages, LoseANodeThatLeavesInOrder) {
  begin();
  ASSERT_EQ(machine->write(test::kMachineWord, 1), Status::Ok);
  images->advance(Time{0});
  images->advance(kLongAfter);
  ASSERT_EQ(controller->presence_of(NodeId{1}).state, broker::Presence::State::Alive);

  ASSERT_EQ(machine->write(test::kMachineWord, 2), Status::Ok);
  machine.reset();
  for (int ms : {10, 20, 30}) images->advance(std::chrono::milliseconds{ms});

  EXPECT_EQ(controller->presence_of(NodeId{1}).state, broker::Presence::State::Absent);
  EXPECT_EQ(seen_by_controller(), 2U);
}

TEST_F(ReplicatedImages, HaveNamesByWhichProcessesFindThemAndAskForFaults) {
  const std::string name = test::unique_ring("images");
  auto named = Images::create(name, test::small_map(kGroup), {});
  auto attached = broker::Ring::attach(image_name(name, "machine"));
  auto node = attached.join("machine", 0);
  auto rings_own = broker::Ring::attach(name);
  const auto monitor = rings_own.observe();
  ASSERT_EQ(node.write(test::kMachineWord, 7), Status::Ok);
  for (int ms : {0, 10, 20}) named.advance(std::chrono::milliseconds{ms});
  EXPECT_EQ(monitor.read(test::kMachineWord), 7U);

  Action fault;
  fault.kind = Action::Kind::Delay;
  fault.node = 1;
  fault.delay = from_ns(250);
  auto done = std::async(std::launch::async, [&] { request_fault(name, fault); });
  Time now = std::chrono::milliseconds{20};
  while (done.wait_for(std::chrono::milliseconds{1}) != std::future_status::ready)
    named.advance(now += kLongAfter);
  EXPECT_NO_THROW(done.get());
  ASSERT_EQ(named.events().size(), 1U);
  EXPECT_EQ(named.events()[0].find("controller delays messages by 250 ns at"), 0U);
}

TEST_F(ReplicatedImages, RefuseFaultsOfASharedRing) {
  const std::string name = test::unique_ring("images_shared");
  const auto shared = broker::Ring::create(name, test::small_map());
  const test::RingRemoval removal{name};

  EXPECT_THROW(request_fault(name, Action{}), Error);
}

}  // namespace
}  // namespace rths::replicated
