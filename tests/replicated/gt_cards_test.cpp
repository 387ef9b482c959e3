// SPDX-License-Identifier: Apache-2.0
//
// GT cards in virtual time. Numbers of states and interrupt types are those of scgtapi.h.
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

constexpr std::uint32_t kUnicast = 0, kBroadcast = 1;
constexpr std::uint32_t kNodeIdState = 0, kWriteMeLast = 4, kUnicastMask = 5, kBroadcastMask = 6,
                        kSelf = 7, kRingSize = 8, kUpstream = 9, kNetTimer = 10, kLatencyTimer = 11,
                        kTransmitState = 15, kReceiveState = 16, kLinkUp = 20, kSignal = 21;

class VirtualGt : public VirtualCards {
 protected:
  void use_gt(std::uint32_t count) { use(nodes(count, CardType::Gt)); }
};

TEST_F(VirtualGt, LetsBytesOfOneLongwordSurvive) {
  use_gt(4);
  for (std::uint32_t node = 0; node < 4; ++node) store_bytes(node, 8 + node, node + 1, 1);
  settle();
  for (std::uint32_t node = 0; node < 4; ++node) EXPECT_EQ(load(node, 2), 0x0403'0201U);
  store_bytes(1, 10, 0xAABB, 2);
  EXPECT_EQ(load(1, 2), 0xAABB'0201U);
  store(1, 3, 0x1234'5678);
  EXPECT_EQ(load(1, 3), 0x1234'5678U);
  settle();
  EXPECT_EQ(load(3, 2), 0xAABB'0201U);
}

// 8 ns per tick: 5 ns/m of fibre, 450 ns of each other node.
TEST_F(VirtualGt, MeasuresTheTimeAroundItsRing) {
  auto setup = nodes(4, CardType::Gt);
  for (auto& node : setup.nodes) node.fibre_m = 100;
  use(setup);
  const std::uint32_t quiet = (4 * 500 + 3 * 450) / 8;
  EXPECT_EQ(card(0).gt_state(kLatencyTimer), quiet);
  EXPECT_EQ(card(0).read_cr(0x48), quiet);
  card(1).set_extra_delay(800ns);
  EXPECT_EQ(card(0).gt_state(kLatencyTimer), quiet + 100);
  EXPECT_EQ(card(1).gt_state(kLatencyTimer), quiet) << "its own delay is not on the way";
  store(0, 5, 1);
  settle();
  EXPECT_EQ(card(0).gt_state(kLatencyTimer), quiet + 100);
  card(1).set_extra_delay(0ns);
  for (std::uint32_t word = 0; word < 128; ++word) store(1, 100 + word, word);
  store(0, 5, 2);
  settle();
  EXPECT_GT(card(0).gt_state(kLatencyTimer), quiet) << "it waited for messages of node 1";
}

TEST_F(VirtualGt, IgnoresDataBeyondItsMemory) {
  auto setup = nodes(3, CardType::Gt);
  setup.nodes[1].memory_bytes = 3 * 4096;
  use(setup);
  const std::uint32_t longwords = 3 * 1024;
  store(0, longwords - 1, 7);
  store(0, longwords, 8);
  store(0, longwords + 1, 9);
  settle();
  EXPECT_EQ(load(1, longwords - 1), 7U);
  EXPECT_EQ(load(1, longwords), 0xFFFF'FFFFU);
  EXPECT_EQ(load(2, longwords), 8U);
}

TEST_F(VirtualGt, DeliversAnInterruptAfterItsData) {
  use_gt(3);
  card(2).set_gt_state(kBroadcastMask, 0xFFFF'FFFF);
  for (std::uint32_t i = 0; i < 100; ++i) {
    for (std::uint32_t word = 0; word < 40; ++word) store(0, word, i + 1);
    card(0).send_interrupt(kBroadcast, 3, i);
    while (card(2).report().interrupt_fifo == 0) pass(10ns);
    EXPECT_EQ(load(2, 39), i + 1);
    const auto interrupt = card(2).take_interrupt();
    ASSERT_TRUE(interrupt);
    EXPECT_EQ(interrupt->type, kBroadcast);
    EXPECT_EQ(interrupt->source, 1U);
    EXPECT_EQ(interrupt->id, 3U);
    EXPECT_EQ(interrupt->value, i);
  }
}

TEST_F(VirtualGt, TakesBroadcastsOfItsMaskOnly) {
  use_gt(2);
  card(1).set_gt_state(kBroadcastMask, 1U << 5);
  for (std::uint32_t number = 0; number < 32; ++number)
    card(0).send_interrupt(kBroadcast, number, number);
  settle();
  EXPECT_EQ(card(1).take_interrupt()->id, 5U);
  EXPECT_FALSE(card(1).take_interrupt());
  EXPECT_EQ(card(1).report().stored, 1U);
  card(1).set_gt_state(kBroadcastMask, 0xFFFF'FFFF);
  card(0).send_interrupt(kBroadcast, 32, 0);  // there are 32
  settle();
  EXPECT_FALSE(card(1).take_interrupt());
}

TEST_F(VirtualGt, TakesUnicastsForItsIdIfEnabled) {
  use_gt(3);
  card(1).set_gt_state(kUnicastMask, 1);
  card(0).send_interrupt(kUnicast, 2, 10);  // node 1
  card(0).send_interrupt(kUnicast, 3, 11);  // node 2: not enabled
  settle();
  const auto interrupt = card(1).take_interrupt();
  ASSERT_TRUE(interrupt);
  EXPECT_EQ(interrupt->id, 0U);
  EXPECT_EQ(interrupt->value, 10U);
  EXPECT_FALSE(card(1).take_interrupt());
  EXPECT_FALSE(card(2).take_interrupt());
  EXPECT_EQ(card(1).report().stored, 1U);
  EXPECT_EQ(card(2).report().stored, 0U);
}

TEST_F(VirtualGt, InterruptsItselfOnlyIfEnabled) {
  use_gt(2);
  card(0).set_gt_state(kBroadcastMask, 0xFF);
  card(0).send_interrupt(kBroadcast, 1, 1);
  settle();
  EXPECT_FALSE(card(0).take_interrupt());
  EXPECT_EQ(card(0).report().stored, 0U);
  card(0).set_gt_state(18, 0);  // laser 0
  card(0).set_gt_state(kSelf, 1);
  card(0).send_interrupt(kBroadcast, 1, 2);
  settle();
  EXPECT_EQ(card(0).take_interrupt()->value, 2U);
}

TEST_F(VirtualGt, KeepsTheOldest256InterruptsOfItsQueue) {
  use_gt(2);
  card(1).set_gt_state(kBroadcastMask, 1);
  for (std::uint32_t i = 0; i < 300; ++i) card(0).send_interrupt(kBroadcast, 0, i);
  settle();
  EXPECT_EQ(card(1).report().lost_interrupts, 44U);
  EXPECT_EQ(card(1).report().stored, 256U);
  for (std::uint32_t i = 0; i < 256; ++i) ASSERT_EQ(card(1).take_interrupt()->value, i);
  EXPECT_FALSE(card(1).take_interrupt());
}

TEST_F(VirtualGt, ShowsTheRingAndRefusesToSetIt) {
  use_gt(5);
  EXPECT_EQ(card(2).gt_state(kRingSize), 5U);
  EXPECT_EQ(card(2).gt_state(kUpstream), 2U);
  EXPECT_EQ(card(2).gt_state(kLinkUp), 1U);
  EXPECT_EQ(card(2).gt_state(kSignal), 1U);
  EXPECT_EQ(card(2).gt_state(kSignal + 1), 1U);
  EXPECT_FALSE(card(2).set_gt_state(kRingSize, 3));
  EXPECT_FALSE(card(2).set_gt_state(kLinkUp, 1));
  card(1).set_power(false);
  EXPECT_EQ(card(2).gt_state(kRingSize), 4U);
  EXPECT_EQ(card(2).gt_state(kUpstream), 1U);
  ring().set_fibre(3, false);
  EXPECT_EQ(card(2).gt_state(kRingSize), 256U);
  EXPECT_EQ(card(2).gt_state(kLinkUp), 0U);
}

TEST_F(VirtualGt, ShowsAnOpenRingIfANodeWithoutASwitchIsOff) {
  RingSetup setup = nodes(3, CardType::Gt);
  for (auto& node : setup.nodes) node.bypass_switch = false;
  use(setup);
  EXPECT_EQ(card(2).gt_state(kRingSize), 3U);
  card(1).set_power(false);
  EXPECT_EQ(card(2).gt_state(kRingSize), 256U);
  EXPECT_EQ(card(2).read_cr(0x14), 0xFF00'0000U);  // neither link nor signals
}

TEST_F(VirtualGt, SendsAndReceivesOnlyIfEnabled) {
  use_gt(3);
  card(0).set_gt_state(kTransmitState, 0);
  card(2).set_gt_state(kReceiveState, 0);
  card(2).set_gt_state(kBroadcastMask, 1);
  card(2).set_gt_state(kUnicastMask, 1);
  EXPECT_EQ(store(0, 1, 5), Access::Local);
  store(1, 2, 6);
  card(1).send_interrupt(kBroadcast, 0, 7);
  card(1).send_interrupt(kUnicast, 3, 7);
  settle();
  EXPECT_FALSE(card(2).take_interrupt());
  EXPECT_EQ(card(1).report().stored, 0U);  // nothing of others
  EXPECT_EQ(card(2).report().stored, 0U);
  EXPECT_EQ(load(1, 1), 0U);
  EXPECT_EQ(load(2, 2), 0U);
  EXPECT_EQ(load(0, 2), 6U);
}

TEST_F(VirtualGt, WritesItselfLastIfEnabled) {
  use_gt(3);
  card(0).set_gt_state(18, 0);  // laser 0
  card(0).set_gt_state(kWriteMeLast, 1);
  store(0, 1, 5);
  EXPECT_EQ(load(0, 1), 0U);
  settle();
  EXPECT_EQ(load(0, 1), 5U);
  EXPECT_EQ(load(2, 1), 5U);
}

TEST_F(VirtualGt, SendsBlocksOf128Bytes) {
  use_gt(2);
  store(1, 64, 7);
  settle();
  for (std::uint32_t i = 0; i < 64; ++i) store(0, i, i + 1);
  settle();
  EXPECT_EQ(load(1, 64), 7U);  // behind the last block
  EXPECT_EQ(card(0).report().sent, 2U);
  for (std::uint32_t i = 0; i < 64; ++i) EXPECT_EQ(load(1, i), i + 1);
}

TEST_F(VirtualGt, RemovesMessagesOfItsOwnIdInStrictMode) {
  RingSetup setup = nodes(3, CardType::Gt);
  setup.strict_ids = true;
  use(setup);
  card(1).set_gt_state(kNodeIdState, 1);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(load(1, 5), 0U);
  EXPECT_EQ(load(2, 5), 0U);
}

TEST_F(VirtualGt, CountsDamagedFrames) {
  use_gt(2);
  ring().set_bit_error_rate(1);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(load(1, 5), 0U);
  EXPECT_EQ(card(1).report().rejected, 1U);
  EXPECT_EQ(card(1).gt_state(2), 1U);
}

// Registers of the states: byte offset, lowest bit, bits.
constexpr struct {
  std::uint32_t state, offset, shift, mask;
} kPlaces[] = {{0, 0x10, 8, 0xFF}, {1, 0x10, 4, 1},      {3, 0x10, 19, 1},
               {4, 0x10, 20, 1},   {5, 0x1C, 0, 1},      {6, 0x18, 0, 0xFFFF'FFFF},
               {7, 0x10, 21, 1},   {14, 0x10, 24, 0xFF}, {15, 0x10, 16, 1},
               {16, 0x10, 17, 1},  {17, 0x10, 18, 1},    {18, 0x10, 0, 1},
               {19, 0x10, 1, 1}};

TEST_F(VirtualGt, KeepsEachStateInItsRegister) {
  for (const auto& place : kPlaces) {
    use_gt(1);
    for (const std::uint32_t value : {0U, place.mask & 0xA5A5'A5A5U, place.mask, 0U}) {
      const std::uint32_t before = card(0).read_cr(place.offset);
      EXPECT_TRUE(card(0).set_gt_state(place.state, value));
      EXPECT_EQ(card(0).gt_state(place.state), value) << place.state;
      EXPECT_EQ(card(0).read_cr(place.offset),
                (before & ~(place.mask << place.shift)) | value << place.shift)
          << place.state;
    }
  }
}

TEST_F(VirtualGt, HasThePowerUpValuesOfTheManual) {
  use_gt(2);
  EXPECT_EQ(card(1).read_cr(0x10), 0x7'0203U);     // transmit, receive, retransmit, lasers, id 2
  EXPECT_EQ(card(1).read_cr(0x14), 0x010E'0000U);  // link up, both signals, age 1
  EXPECT_EQ(card(1).read_cr(0x18), 0U);
  EXPECT_EQ(card(1).read_cr(0x1C), 0U);
  EXPECT_EQ(card(1).read_cr(0x20), 1U << 24);  // upstream id
  EXPECT_EQ(card(1).read_cr(0x100), 0xFFFF'FFFFU);
  EXPECT_EQ(card(1).gt_state(28), 0xFFFF'FFFFU);
  EXPECT_FALSE(card(1).set_gt_state(28, 1));
  card(1).write_cr(0x14, 0);
  card(1).write_cr(0, 7);
  EXPECT_EQ(card(1).read_cr(0x14), 0x010E'0000U);
  EXPECT_EQ(card(1).read_cr(0), 0U);
  card(1).write_cr(0x20, 0xFF00'0005);
  EXPECT_EQ(card(1).read_cr(0x20), 0x0100'0005U);
}

TEST_F(VirtualGt, KeepsItsOwnStatesApart) {
  use_gt(1);
  const std::uint32_t own[] = {12, 13};
  for (std::uint32_t i = 0; i < 2; ++i) EXPECT_TRUE(card(0).set_gt_state(own[i], 0xFFFF'FFFF - i));
  EXPECT_TRUE(card(0).set_gt_state(26, 5));
  for (const std::uint32_t value : {3U, 0U}) {
    EXPECT_TRUE(card(0).set_gt_state(27, value));
    EXPECT_EQ(card(0).gt_state(27), value != 0 ? 1U : 0U);
  }
  EXPECT_TRUE(card(0).set_gt_state(2, 9));  // errors cannot be set
  for (std::uint32_t i = 0; i < 2; ++i) EXPECT_EQ(card(0).gt_state(own[i]), 0xFFFF'FFFF - i);
  EXPECT_EQ(card(0).gt_state(26), 1U);
  EXPECT_EQ(card(0).gt_state(27), 0U);
  EXPECT_EQ(card(0).gt_state(2), 0U);
  EXPECT_TRUE(card(0).set_gt_state(kTransmitState, 2));  // any value but zero is true
  EXPECT_EQ(card(0).gt_state(kTransmitState), 1U);
  EXPECT_TRUE(card(0).set_gt_state(kUnicastMask, 2));  // bit 0 only
  EXPECT_EQ(card(0).gt_state(kUnicastMask), 0U);
  EXPECT_TRUE(card(0).set_gt_state(23, 7));  // D64: on is a clear bit
  EXPECT_EQ(card(0).gt_state(23), 1U);
  EXPECT_EQ(card(0).read_cr(8), 0U);
  EXPECT_TRUE(card(0).set_gt_state(23, 0));
  EXPECT_EQ(card(0).read_cr(8), 0x10U);
  EXPECT_EQ(card(0).gt_state(23), 0U);
  EXPECT_TRUE(card(0).set_gt_state(24, 0));
  EXPECT_FALSE(card(0).set_gt_state(24, 1));  // swaps are not supported
  EXPECT_FALSE(card(0).set_gt_state(25, 1));
  for (const std::uint32_t bit : {0U, 1U, 2U, 3U}) {
    card(0).write_cr(8, 1U << bit);
    EXPECT_EQ(card(0).gt_state(24), bit == 1 ? 1U : 0U);
    EXPECT_EQ(card(0).gt_state(25), bit == 0 ? 1U : 0U);
  }
  EXPECT_FALSE(card(0).set_gt_state(9, 1));
  EXPECT_FALSE(card(0).set_gt_state(21, 1));
  EXPECT_FALSE(card(0).set_gt_state(22, 1));
}

TEST_F(VirtualGt, ReturnsItsMessagesInsideTheCardWithEwrap) {
  for (const bool by_state : {true, false}) {
    use_gt(2);
    if (by_state)
      EXPECT_TRUE(card(0).set_gt_state(3, 1));
    else
      card(0).write_cr(0x10, 0x9'0100);  // id 1, transmits, EWRAP; nothing else
    store(0, 1, 5);
    settle();
    EXPECT_EQ(load(1, 1), 0U);
    EXPECT_EQ(hops(Hop::Kind::Removed, 0).size(), 1U);
  }
}

TEST_F(VirtualGt, SendsQueuedStoresWhenTransmitIsEnabled) {
  for (const bool by_state : {true, false}) {
    use_gt(2);
    const std::uint32_t control = card(0).read_cr(0x10);
    store(0, 1, 5);
    card(0).set_gt_state(kTransmitState, 0);
    pass(10us);
    EXPECT_EQ(load(1, 1), 0U);
    if (by_state)
      EXPECT_TRUE(card(0).set_gt_state(kTransmitState, 1));
    else
      card(0).write_cr(0x10, control);
    settle();
    EXPECT_EQ(load(1, 1), 5U);
  }
}

TEST_F(VirtualGt, ForgetsItsStatesWithThePower) {
  use_gt(2);
  for (const std::uint32_t state : {5U, 6U, 7U, 11U, 12U, 13U, 26U, 27U})
    EXPECT_TRUE(card(0).set_gt_state(state, 1));
  card(0).write_cr(0x24, 9);
  card(0).write_cr(0x100, 7);  // no register
  EXPECT_EQ(card(0).gt_state(2), 0U);
  pass(1ms);
  card(0).set_power(false);
  card(0).set_power(true);
  for (const std::uint32_t state : {2U, 5U, 6U, 7U, kNetTimer, 12U, 13U, 26U, 27U})
    EXPECT_EQ(card(0).gt_state(state), 0U) << state;
  for (std::uint32_t offset = 0; offset < 0x100; offset += 4)
    if (offset != 0x10 && offset != 0x14 && offset != 0x20 && offset != 0x48) {
      EXPECT_EQ(card(0).read_cr(offset), 0U) << offset;
    }
}

TEST_F(VirtualGt, HasATimerOf8NsInVirtualTime) {
  use_gt(1);
  const std::uint32_t before = card(0).gt_state(kNetTimer);
  pass(80us);
  EXPECT_EQ(card(0).gt_state(kNetTimer) - before, 10'000U);
  card(0).set_gt_state(kNetTimer, 500);
  pass(8us);
  EXPECT_EQ(card(0).gt_state(kNetTimer), 1500U);
  card(0).write_cr(0x40, 7);
  pass(8us);
  EXPECT_EQ(card(0).read_cr(0x40), 1007U);
}

}  // namespace
}  // namespace rths::test
