// SPDX-License-Identifier: Apache-2.0
//
// Cards whose registers are in the objects of images, where a host in another process uses them.
// The test is that host.
#include <csignal>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include <rths/broker/detail/process.hpp>
#include <rths/card/bits.hpp>
#include <rths/card/card_table.hpp>
#include <rths/card/registers.hpp>
#include <rths/replicated/images.hpp>

#include "support/ring_maps.hpp"

namespace rths::replicated {
namespace {

namespace csr1 = scramnet::csr1;

/// The test is host of the machine's card; the controller uses our library.
class SharedCards : public testing::Test {
 protected:
  void begin(const CardOptions& options = {}) {
    images.emplace(Images::create(name, test::small_map(), options));
    ring.emplace(broker::Ring::attach(image_name(name, "machine")));
    table = std::make_unique<scramnet::CardTable>(*ring, image_name(name, "machine"));
    card = table->at(0)->card;
    card->carried.plain_host.store(1);
    machine.emplace(ring->join_plain("machine"));
    controller.emplace(images->of("controller").join("controller", 0));
    advance();
    write_csr(0, 0x8003);
    advance();
  }
  void TearDown() override {
    machine.reset();
    controller.reset();
    table.reset();
    ring.reset();
    images.reset();
  }
  /// Long enough for all messages, and for the next look at the nodes.
  void advance() {
    for (int i = 0; i < 3; ++i) images->advance(now += std::chrono::milliseconds{6});
  }
  void store(std::uint32_t value) {
    machine->plain_memory()[test::kMachineWord.value()] = value;
    advance();
  }
  void write(std::uint32_t value) {
    ASSERT_EQ(controller->write(test::kControllerWord, value), Status::Ok);
    advance();
  }
  void write_csr(int index, std::uint32_t value) { scramnet::Registers{*card}.write(index, value); }
  [[nodiscard]] scramnet::Carried& carried() const { return card->carried; }

  const std::string name = test::unique_ring("shared_cards");
  std::optional<Images> images;
  std::optional<broker::Ring> ring;
  std::unique_ptr<scramnet::CardTable> table;
  scramnet::Card* card = nullptr;
  std::optional<broker::Node> machine, controller;
  Time now{0};
};

TEST_F(SharedCards, ShowTheirMessagesToTheirHost) {
  begin();
  EXPECT_EQ(carried().active.load(), 1U);
  EXPECT_EQ(carried().ring_nodes.load(), 0U);
  store(7);
  EXPECT_EQ(controller->read(test::kMachineWord), 7U);
  EXPECT_EQ(carried().sent.load(), 1U);
  EXPECT_EQ(carried().ring_nodes.load(), 2U);
  write(8);
  write(9);
  EXPECT_EQ(carried().stored.load(), 2U);
  EXPECT_EQ(carried().rejected.load(), 0U);
  EXPECT_EQ(carried().same_id.load(), 0U);
  write_csr(3, 2 << 8);  // the controller's id
  write(10);
  EXPECT_EQ(carried().same_id.load(), 1U);
  const std::uint32_t scans = carried().scans.load();
  images->advance(now += std::chrono::milliseconds{1});
  EXPECT_EQ(carried().scans.load(), scans + 1);
}

TEST_F(SharedCards, CountDamagedMessages) {
  CardOptions options;
  options.bit_error_rate = 1;
  begin(options);
  write(8);
  EXPECT_EQ(carried().rejected.load(), 1U);
  EXPECT_EQ(carried().stored.load(), 0U);
  EXPECT_EQ(card->plus.latched.load(), csr1::kBadMessage);
}

TEST_F(SharedCards, TakeTheRegistersOfTheirHost) {
  begin();
  write_csr(0, 0x8001);
  store(1);
  EXPECT_EQ(carried().transmit_fifo.load(), 1U);
  EXPECT_EQ(carried().live_status.load(), csr1::kTransmitFifoNotEmpty);
  carried().transmit_resets.fetch_add(1);
  advance();
  EXPECT_EQ(carried().transmit_fifo.load(), 0U);
  EXPECT_EQ(carried().live_status.load(), 0U);
  store(2);
  EXPECT_EQ(carried().transmit_fifo.load(), 1U);
  write_csr(0, 0x8003);
  advance();
  EXPECT_EQ(controller->read(test::kMachineWord), 2U);
  write_csr(0, 0);  // out of the ring: its messages do not come
  advance();
  write(5);
  EXPECT_EQ(carried().stored.load(), 0U);
}

// 82 bits, one node of 37 bits, and three fibres of 10 m, in ticks of 4 bits.
TEST_F(SharedCards, MeasureTheRingOncePerWriteOfTheCounter) {
  begin();
  write_csr(9, 0x4000);
  write_csr(13, 0);
  carried().counter_writes.fetch_add(1);
  advance();
  store(1);
  EXPECT_EQ(card->plus.counter.load(), (82 * 100 + 37 * 100 + 3 * 750) / 400);
  card->plus.counter.store(5);
  store(2);
  EXPECT_EQ(card->plus.counter.load(), 5U);
}

TEST_F(SharedCards, InterruptTheirHost) {
  begin();
  write_csr(8, 0x0C00);  // every message interrupts
  write_csr(0, 0x806B);
  write_csr(1, 0);
  EXPECT_EQ(card->plus.armed.load(), 1U);
  advance();
  write(5);
  EXPECT_EQ(card->plus.host_interrupts.load(), 1U);
  EXPECT_EQ(card->plus.armed.load(), 0U);
  EXPECT_EQ(card->plus.fifo.address[0].load(), 4 * test::kControllerWord.value());
  table->at(0)->acr[test::kControllerWord.value()].store(scramnet::acr::kTriggerOnMessage);
  write_csr(0, 0x8003);
  write_csr(9, 0x2000);  // counts triggers
  write(6);
  EXPECT_EQ(card->plus.counter.load(), 1U);
}

volatile std::sig_atomic_t signals = 0;

TEST_F(SharedCards, SendASignalToARegisteredHost) {
  begin();
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int) { signals = signals + 1; };
  ASSERT_EQ(sigaction(SIGUSR1, &action, &before), 0);
  card->plus.registered[0].store(broker::own_claim());
  write_csr(8, 0x0C00);  // every message interrupts
  write_csr(0, 0x806B);
  write_csr(1, 0);
  advance();
  write(5);
  EXPECT_EQ(signals, 1);
  card->plus.registered[0].store(0);
  sigaction(SIGUSR1, &before, nullptr);
}

// A host of our library writes as a program does: also through the window to the ACR.
TEST_F(SharedCards, HaveTheAcrOfTheirHost) {
  begin();
  auto controllers_ring = broker::Ring::attach(image_name(name, "controller"));
  const scramnet::CardTable controllers{controllers_ring, image_name(name, "controller")};
  scramnet::Registers{*controllers.at(0)->card}.write(0, 0x8013);
  write(0x1F);
  EXPECT_EQ(controllers.at(0)->acr[test::kControllerWord.value()].load(), 0x1FU);
}

TEST(SizeCodes, AreThoseOfTheManual) {
  constexpr std::uint64_t kKilo = 1024;
  constexpr std::uint64_t kSizes[] = {
      0,           8192 * kKilo, 4096 * kKilo, 2048 * kKilo, 1024 * kKilo,
      512 * kKilo, 128 * kKilo,  4 * kKilo};
  for (std::uint32_t code = 0; code < 8; ++code)
    EXPECT_EQ(scramnet::bytes_of_size_code(code), kSizes[code]);
  EXPECT_EQ(scramnet::bytes_of_size_code(9), kSizes[1]);  // of three bits
}

TEST_F(SharedCards, StandStillWithoutPower) {
  CardOptions options;
  Fault off;
  off.node = "machine";
  off.action.kind = Action::Kind::PowerOff;
  off.action.at = std::chrono::milliseconds{50};
  options.faults = {off};
  begin(options);
  for (const int longword : {0, 3}) table->at(0)->acr[longword].store(1);
  table->at(0)->known[0].store(1);  // behind the ACR
  now = std::chrono::milliseconds{60};
  advance();
  const std::uint32_t scans = carried().scans.load();
  advance();
  EXPECT_EQ(carried().scans.load(), scans);
  for (const int longword : {0, 3}) EXPECT_EQ(table->at(0)->acr[longword].load(), 0U);
  EXPECT_EQ(table->at(0)->known[0].load(), 1U);
}

// A host that stores through a pointer inserts its card itself; one of our library need not.
TEST_F(SharedCards, AreInsertedByAHostThatStoresThroughAPointer) {
  begin();
  write_csr(0, 0);
  machine.reset();
  advance();
  EXPECT_EQ(carried().plain_host.load(), 0U);
  EXPECT_EQ(card->plus.csr[0].load(), 0U);
  auto node = ring->join("machine", 0);
  advance();
  EXPECT_EQ(card->plus.csr[0].load(), 0x8003U);
}

}  // namespace
}  // namespace rths::replicated
