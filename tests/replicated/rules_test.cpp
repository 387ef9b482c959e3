// SPDX-License-Identifier: Apache-2.0
//
// Boundaries of the cards' rules: one entry, one bit or one state more or less.
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

class Rules : public VirtualCards {};

TEST_F(Rules, AcceptTheLimitsOfASetup) {
  EXPECT_NO_THROW(replicated::Ring{nodes(256)});  // with ids up to 255
  RingSetup setup = nodes(1);
  setup.nodes[0].fibre_m = 0;
  setup.nodes[0].memory_bytes = 4;
  EXPECT_NO_THROW(replicated::Ring{setup});
}

TEST_F(Rules, EndTheMemoryOfAGtCardAtItsSize) {
  RingSetup setup = nodes(2, CardType::Gt);
  setup.nodes[1].memory_bytes = 4096;
  use(setup);
  store(0, 1023, 5);
  store(0, 1024, 6);
  settle();
  EXPECT_EQ(load(1, 1023), 5U);
  EXPECT_EQ(load(1, 1024), 0xFFFF'FFFFU);
  EXPECT_EQ(card(0).send_interrupt(1, 3, 0), Access::Queued);
}

TEST_F(Rules, EndTheMemoryOfAPlusCardAtItsSize) {
  RingSetup setup = nodes(2);
  setup.nodes[1].memory_bytes = 4096;
  use_inserted(setup);
  csr(1, 8, 0xC00);  // every message interrupts
  csr(1, 0, 0x806B);
  store(0, 1024, 6);
  store(0, 1023, 5);
  settle();
  EXPECT_EQ(load(1, 1023), 5U);
  EXPECT_EQ(load(1, 1024), 0xFFFF'FFFFU);
  EXPECT_EQ(interrupt(1), 4 * 1023);
  EXPECT_EQ(interrupt(1), -1);
}

// Sending and filtering do not need the receiver.
TEST_F(Rules, OfStoresNeedNoReceiver) {
  use_inserted(2);
  csr(1, 0, 0x806B);
  csr(0, 0, 0x8302);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(interrupt(1), 20);
  constexpr std::uint32_t kLow = 7, kHigh = 2000;
  csr(0, 0, 0x8402);
  EXPECT_EQ(store(0, kHigh, 0), Access::Filtered);
  EXPECT_EQ(store(0, kLow, 0), Access::Queued);
  csr(0, 0, 0x8C02);
  EXPECT_EQ(store(0, kLow, 0), Access::Filtered);
  csr(0, 0, 0x0010);
  EXPECT_EQ(store(0, kLow, 3), Access::Local);
  EXPECT_EQ(load(0, kLow), 3U);
  csr(0, 0, 0);
  EXPECT_EQ(load(0, kLow), 0U);
}

TEST_F(Rules, OfReceptionDoNotChangeStores) {
  use_inserted(2, kBurst | 0x2000);
  csr(0, 0, 0x8103);
  csr(0, 9, 0x2000);  // counts triggers
  csr(1, 0, 0x806B);
  acr(0, 5, 1);
  EXPECT_EQ(store_bytes(0, 20, 1, 1), Access::Queued);
  settle();
  EXPECT_EQ(interrupt(1), -1);
  EXPECT_EQ(csr(0, 13), 0U);
}

TEST_F(Rules, HoldOffOnlyStoresThatAreSent) {
  use_inserted(2);
  csr(0, 0, 0x8001 | 0xC00);
  for (std::uint32_t i = 0; i < 1024; ++i) EXPECT_EQ(store(0, i, 1), Access::Queued);
  EXPECT_EQ(store(0, 7, 1), Access::Filtered);
  EXPECT_EQ(store(0, 7, 2), Access::HeldOff);
  EXPECT_EQ(load(0, 7), 1U);
  csr(0, 0, 0x8000);
  EXPECT_EQ(store(0, 7, 2), Access::Local);
  EXPECT_EQ(load(0, 7), 2U);
}

TEST_F(Rules, HoldOffInterruptsOfGtCards) {
  use(nodes(2, CardType::Gt));
  for (std::uint32_t i = 0; i < 1024; ++i)
    ASSERT_EQ(card(0).send_interrupt(1, 0, i), Access::Queued);
  EXPECT_EQ(card(0).send_interrupt(1, 0, 0), Access::HeldOff);
  EXPECT_EQ(store(0, 1, 1), Access::HeldOff);
  EXPECT_EQ(load(0, 1), 0U);
  card(0).set_gt_state(15, 0);
  EXPECT_EQ(card(0).send_interrupt(1, 0, 0), Access::Local);
  EXPECT_EQ(store(0, 1, 1), Access::Local);
}

TEST_F(Rules, CollectTheBytesOfOneHiProWordAtATime) {
  use_inserted(2, kBurst | 0x2000);
  acr(0, 5, 0x10);
  acr(0, 6, 0x10);
  EXPECT_EQ(store_bytes(0, 20, 0x1111, 2), Access::Withheld);
  EXPECT_EQ(store_bytes(0, 24, 0x3333, 2), Access::Withheld);  // begins again
  EXPECT_EQ(store_bytes(0, 22, 0x2222, 2), Access::Withheld);
  EXPECT_EQ(store(0, 5, 7), Access::Queued);  // ends the collection
  EXPECT_EQ(store_bytes(0, 20, 0x1111, 2), Access::Withheld);
  csr(0, 0, kOnRing | 0x4000);
  csr(0, 0, kOnRing);  // so does a reset of the transmit FIFO
  EXPECT_EQ(store_bytes(0, 22, 0x2222, 2), Access::Withheld);
  EXPECT_EQ(store_bytes(0, 20, 0x1111, 2), Access::Queued);
  EXPECT_EQ(store_bytes(0, 22, 0x2222, 2), Access::Withheld);  // the next collection
}

TEST_F(Rules, TakeLowBytesOnlyInTheAcrWindow) {
  use_inserted(2);
  acr(0, 4, 3);
  csr(0, 0, kOnRing | 0x10);
  for (const std::uint32_t byte : {1U, 2U, 3U}) {
    EXPECT_EQ(store_bytes(0, 16 + byte, 0x1F, 1), Access::Local);
    EXPECT_EQ(card(0).read(ByteOffset{16 + byte}, 1), 0U);
  }
  EXPECT_EQ(load(0, 4), 3U);
  EXPECT_EQ(store_bytes(0, 16, 5, 1), Access::Local);
  EXPECT_EQ(load(0, 4), 5U);
}

TEST_F(Rules, ChangeNothingWhenRegistersAreLookedAt) {
  RingSetup setup = nodes(2);
  setup.nodes[1].bypass_switch = false;
  use_inserted(setup);
  csr(0, 0, 0x8303);
  csr(1, 0, 0x806B);
  store(0, 0x4'0005, 1);
  store(0, 3, 1);
  settle();
  EXPECT_EQ(card(0).peek_csr(1), 0U);
  EXPECT_EQ(card(1).peek_csr(1), 0x8000U);
  csr(1, 0, 0x8063);
  csr(1, 1, 0);
  EXPECT_EQ(card(1).peek_csr(1), 0xC000U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(card(1).peek_csr(5), 0x8010U);
    EXPECT_EQ(card(1).peek_csr(4), 20U);
  }
  EXPECT_EQ(interrupt(1), 0x10'0014);
  EXPECT_EQ(interrupt(1), 12);
  EXPECT_EQ(card(1).peek_csr(4), 0U);
  EXPECT_EQ(csr(1, 4), 0U);
}

TEST_F(Rules, ClearEveryQueueWithThePower) {
  use_inserted(2);
  csr(0, 0, 0x8001);
  store(0, 3, 4);
  acr(0, 3, 1);
  card(0).set_power(true);  // is on
  EXPECT_EQ(card(0).report().transmit_fifo, 1U);
  card(0).set_power(false);
  EXPECT_FALSE(card(0).report().powered);
  EXPECT_EQ(card(0).report().transmit_fifo, 0U);
  EXPECT_EQ(load(0, 3), 0xFFFF'FFFFU);
  card(0).set_power(true);
  EXPECT_TRUE(card(0).report().powered);
  EXPECT_EQ(load(0, 3), 0U);
  use(nodes(2, CardType::Gt));
  card(1).set_gt_state(6, 1);
  card(0).send_interrupt(1, 0, 1);
  settle();
  EXPECT_EQ(card(1).report().interrupt_fifo, 1U);
  card(1).set_power(false);
  EXPECT_FALSE(card(1).take_interrupt());
  EXPECT_EQ(card(1).send_interrupt(1, 0, 1), Access::Local);
  card(1).set_power(true);
  EXPECT_EQ(card(1).gt_state(0), 2U);  // its id
}

TEST_F(Rules, KeepSixteenBitsOfARegister) {
  use(nodes(1));
  for (const int index : {2, 10, 11, 12}) {
    csr(0, index, 0x1'2345);
    EXPECT_EQ(csr(0, index), 0x2345U) << index;
  }
  csr(0, 3, 0x2AFF);
  EXPECT_EQ(csr(0, 3), 0x2A00U);  // no ring has been measured
  csr(0, 15, 7);
  EXPECT_EQ(csr(0, 15), 0x20U);
  csr(0, 9, 0);
  EXPECT_EQ(csr(0, 9), 8U);  // the self-test reads as ones
}

TEST_F(Rules, ClearEveryStateByCsr8) {
  use_inserted(2);
  csr(1, 0, 0x8303);
  csr(0, 0, 0x806B);
  csr(0, 8, 0x801);
  csr(0, 3, 0x0109);
  csr(0, 8, 0x800);
  csr(0, 9, 0x6000);
  store(1, 5, 1);
  settle();
  EXPECT_EQ(csr(0, 13), 1U);
  EXPECT_EQ(card(0).report().interrupt_fifo, 1U);
  ring().set_bit_error_rate(1);
  store(1, 6, 1);
  settle();
  EXPECT_EQ(card(0).peek_csr(1) & 0x80, 0x80U);
  EXPECT_EQ(card(0).peek_csr(16), 0U);
  csr(0, 8, 0x100);
  EXPECT_EQ(card(0).peek_csr(1) & 0x80, 0U);
  EXPECT_EQ(card(0).report().interrupt_fifo, 0U);
  EXPECT_EQ(csr(0, 13), 0U);
  EXPECT_EQ(csr(0, 11), 0x80U);
  EXPECT_EQ(csr(0, 2), 0xC040U);
  csr(0, 8, 1);
  EXPECT_EQ(csr(0, 3), 0x0100U);  // receive id, and age 0
}

// Both ids are one byte; that of a repetition is the first one's.
TEST_F(Rules, AllowIdsOfOneByte) {
  RingSetup setup = nodes(2);
  setup.nodes[0].id = 255;
  setup.nodes[1].id = 0;
  use_inserted(setup);
  EXPECT_EQ(csr(0, 3) >> 8, 255U);
  EXPECT_EQ(csr(1, 3) >> 8, 0U);
  store(0, 1, 5);
  store(1, 2, 6);
  settle();
  EXPECT_EQ(load(1, 1), 5U);
  EXPECT_EQ(load(0, 2), 6U);
  EXPECT_EQ(card(0).report().same_id, 0U);
}

// Observable properties of a node's path: does it pass the ring on, with its delay; do its own
// messages reach others; do they return to it.
struct Seen {
  bool passes, delays, sends, returns;
  bool operator==(const Seen&) const = default;
};

// Insertion, loopback by wire, by fibre (needs the switch) and by the switch itself.
TEST_F(Rules, OfLoopbackDecideTheWayOfMessages) {
  for (std::uint32_t bits = 0; bits < 32; ++bits) {
    const bool insert = (bits & 1) != 0, wire = (bits & 2) != 0, no_fibre = (bits & 4) != 0,
               no_switch = (bits & 8) != 0, bypass = (bits & 16) != 0;
    RingSetup setup = nodes(3);
    setup.nodes[1].bypass_switch = bypass;
    use_inserted(setup);
    csr(1, 8, no_switch ? 0x800 : 0);
    csr(1, 2, 0xC000U | (wire ? 0x80U : 0U) | (no_fibre ? 0x40U : 0U));
    csr(1, 0, insert ? 0x8003 : 3);
    store(0, 5, 1);
    settle();
    store(1, 6, 2);
    pass(10us);
    const bool loops = insert && !wire && (!no_switch || (!no_fibre && bypass));
    Seen expected{bypass, false, false, wire || loops};
    if (insert && wire) expected.passes = false;
    if (insert && !wire && !loops) expected = {true, true, true, true};
    const Seen seen{load(2, 5) == 1, card(1).report().passed == 1, load(2, 6) == 2,
                    hops(Hop::Kind::Removed, 1).size() == 1};
    EXPECT_EQ(seen, expected) << bits;
    EXPECT_EQ(card(1).report().transmit_fifo, wire || insert ? 0U : 1U) << bits;
  }
}

TEST_F(Rules, TakeTheCarrierFromTheNearestSender) {
  const auto has_carrier = [&](std::uint32_t node) { return (csr(node, 1) & 0x40) == 0; };
  use_inserted(4);
  csr(1, 0, 0);
  csr(2, 0, 0);
  EXPECT_TRUE(has_carrier(3));  // from node 0, past two switches
  EXPECT_TRUE(has_carrier(0));
  csr(0, 0, 0);
  EXPECT_TRUE(has_carrier(3));  // from itself
  csr(3, 0, 0);
  EXPECT_FALSE(has_carrier(3));
  csr(3, 2, 0xC0C0);
  EXPECT_TRUE(has_carrier(3));  // looped inside the card
  EXPECT_FALSE(has_carrier(0));
  csr(3, 0, 0x8003);  // breaks the ring
  EXPECT_TRUE(has_carrier(3));
  EXPECT_FALSE(has_carrier(0));
  RingSetup setup = nodes(3);
  setup.nodes[1].bypass_switch = false;
  use_inserted(setup);
  EXPECT_TRUE(has_carrier(2));
  csr(1, 0, 0);
  EXPECT_FALSE(has_carrier(2));
  EXPECT_TRUE(has_carrier(1));
}

TEST_F(Rules, CountALostCarrierAsOneError) {
  use_inserted(3);
  ring().set_fibre(0, false);
  EXPECT_EQ(csr(1, 13), 1U);
  EXPECT_EQ(csr(2, 13), 0U);
  use(nodes(3, CardType::Gt));
  ring().set_fibre(0, false);
  store(0, 1, 1);
  settle();
  EXPECT_EQ(load(1, 1), 0U);
  ring().set_fibre(0, true);
  EXPECT_EQ(card(1).gt_state(20), 1U);
}

TEST_F(Rules, OfStrictIdsLetANodeTakeAnothersMessageForItsOwn) {
  RingSetup setup = nodes(3);
  setup.nodes[1].id = 1;
  setup.strict_ids = true;
  use_inserted(setup, kBurst | 0x200);
  store(0, 1, 11);
  settle();
  EXPECT_EQ(load(1, 1), 11U);  // node 1 receives it as its own
  EXPECT_EQ(csr(1, 3) & 0xFF, 0U);
  EXPECT_EQ(csr(0, 3) & 0xFF, 0U);
}

}  // namespace
}  // namespace rths::test
