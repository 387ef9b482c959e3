// SPDX-License-Identifier: Apache-2.0
//
// The way of messages: who sees which store, in which order, and when a message ends.
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

class Messages : public VirtualCards {};

TEST_F(Messages, CarryAStoreToEveryNodeThatReceives) {
  use_inserted(5);
  store(2, 77, 0xDEAD'BEEF);
  EXPECT_EQ(load(2, 77), 0xDEAD'BEEFU);
  EXPECT_EQ(load(3, 77), 0U);
  settle();
  for (std::uint32_t node = 0; node < 5; ++node) EXPECT_EQ(load(node, 77), 0xDEAD'BEEFU);
  EXPECT_EQ(hops(Hop::Kind::Removed, 2).size(), 1U);
}

TEST_F(Messages, OfOneNodeArriveInProgramOrder) {
  use_inserted(4);
  for (std::uint32_t i = 0; i < 200; ++i) {
    store(0, 10, i);  // data, then its flag
    store(0, 11, i);
  }
  std::uint32_t seen = 0;
  while (!ring().run_until_idle(ring().now() + 100ns)) {
    EXPECT_GE(load(3, 10), load(3, 11));
    seen += load(3, 10) != load(3, 11) ? 1 : 0;
  }
  EXPECT_GT(seen, 100U);
}

TEST_F(Messages, OfBytesCarryTheWholeLongwordAndMayClobber) {
  use_inserted(2);
  store_bytes(0, 4, 0x11, 1);
  store_bytes(1, 5, 0x22, 1);  // before the other byte has arrived
  settle();
  EXPECT_EQ(load(0, 1), 0x2200U);
  EXPECT_EQ(load(1, 1), 0x0011U);
  store_bytes(0, 6, 0x3333, 2);
  settle();
  EXPECT_EQ(load(1, 1), 0x3333'2200U);
}

TEST_F(Messages, OfSixtyFourBitsAreTwoThatCanBeSeenApart) {
  use_inserted(2);
  store(0, 2, 1);
  store(0, 3, 1);
  ring().run_until(replicated::from_ns(kMessageNs + 50 + 1));
  EXPECT_EQ(load(1, 2), 1U);
  EXPECT_EQ(load(1, 3), 0U);
  settle();
  EXPECT_EQ(load(1, 3), 1U);
}

TEST_F(Messages, OfTheSameValueAreSentWhileTheFilterIsOff) {
  use_inserted(2);
  store(0, 2, 5);
  settle();
  store(1, 2, 6);
  settle();
  store(0, 2, 6);
  settle();
  EXPECT_EQ(card(0).report().sent, 2U);
  EXPECT_EQ(load(1, 2), 6U);
}

TEST_F(Messages, OfTwoWritersOfAWordLeaveDifferentValues) {
  use_inserted(4);
  store(0, 9, 100);
  store(2, 9, 200);
  settle();
  // Each writer ends with the other's value.
  EXPECT_EQ(load(0, 9), 200U);
  EXPECT_EQ(load(2, 9), 100U);
  EXPECT_EQ(load(1, 9), 200U);
  EXPECT_EQ(load(3, 9), 100U);
}

TEST_F(Messages, BeforeANodeJoinedDoNotReachIt) {
  use_inserted(3);
  csr(2, 0, 0);
  store(0, 1, 11);
  settle();
  csr(2, 0, kOnRing);
  store(0, 2, 22);
  settle();
  EXPECT_EQ(load(2, 1), 0U);
  EXPECT_EQ(load(2, 2), 22U);
}

TEST_F(Messages, PassANodeThatIsOutOfTheRingWithoutDelay) {
  use_inserted(3);
  csr(1, 0, 0);
  store(0, 1, 11);
  settle();
  EXPECT_NEAR(to_ns(hops(Hop::Kind::Stored, 2)[0].begin), kMessageNs + 2 * 10 * kMetreNs, kTickNs);
  EXPECT_EQ(card(1).report().passed, 0U);
}

TEST_F(Messages, EndWhenTheirAgeRunsPast255) {
  use_inserted(2);
  csr(0, 8, csr(0, 8) | 1);
  csr(0, 3, 99 << 8 | 250);  // receives id 99, sends with id 1 and age 250
  store(0, 1, 11);
  settle();
  // Ages 250 to 255: six receptions, alternately at both nodes.
  EXPECT_EQ(hops(Hop::Kind::Stored, 1).size(), 3U);
  EXPECT_EQ(hops(Hop::Kind::Stored, 0).size(), 3U);
  EXPECT_EQ(hops(Hop::Kind::Expired, 0).size(), 1U);
}

TEST_F(Messages, CountTheNodesOfTheRingOnTheirWay) {
  use_inserted(7);
  EXPECT_EQ(csr(3, 3) & 0xFF, 0U);  // not before an own message
  store(3, 1, 11);
  settle();
  EXPECT_EQ(csr(3, 3), 4U << 8 | 7U);
  csr(3, 8, csr(3, 8) | 1);
  csr(3, 3, 4U << 8 | 9U);  // its messages start at age 9
  csr(3, 8, csr(3, 8) & ~1U);
  store(3, 1, 12);
  settle();
  EXPECT_EQ(csr(3, 3), 4U << 8 | 7U);
}

TEST_F(Messages, WithAnotherNodesIdAreReportedAndDelivered) {
  RingSetup setup = nodes(3);
  setup.nodes[1].id = 1;
  use_inserted(setup);
  store(0, 1, 11);
  settle();
  EXPECT_EQ(load(1, 1), 11U);
  EXPECT_EQ(load(2, 1), 11U);
  EXPECT_EQ(card(1).report().same_id, 1U);
  EXPECT_EQ(card(2).report().same_id, 0U);
}

TEST_F(Messages, WithAnotherNodesIdAreSwallowedInStrictMode) {
  RingSetup setup = nodes(3);
  setup.nodes[1].id = 1;
  setup.strict_ids = true;
  use_inserted(setup);
  store(0, 1, 11);
  settle();
  EXPECT_EQ(load(1, 1), 0U);
  EXPECT_EQ(load(2, 1), 0U);
  EXPECT_EQ(hops(Hop::Kind::Removed, 1).size(), 1U);
}

TEST_F(Messages, OfABlockKeepOrderAndValues) {
  use_inserted(3, kBurst1024);
  for (std::uint32_t i = 0; i < 600; ++i) store(0, 100 + i, i * 7);
  settle();
  EXPECT_EQ(card(0).report().sent, 3U);  // 256, 256, 88
  for (std::uint32_t i = 0; i < 600; ++i) ASSERT_EQ(load(2, 100 + i), i * 7);
}

TEST_F(Messages, OfOthersWaitInTheInsertionRegister) {
  use_inserted(4);
  csr(2, 2, kBurst1024);
  for (std::uint32_t i = 0; i < 256; ++i) store(2, i, i);
  for (std::uint32_t i = 0; i < 5; ++i) store(0, 1000 + i, i);
  for (std::uint32_t i = 0; i < 3; ++i) store(1, 2000 + i, i);
  pass(30us);
  // The head of the block has been around: every node is sending it on. Before, two messages came.
  EXPECT_EQ(card(2).report().waiting, 2U);
  EXPECT_EQ(card(2).report().oldest_age, 2U);  // of the message of node 0
  EXPECT_EQ(card(0).report().transmit_fifo, 4U);
  EXPECT_EQ(card(1).report().waiting, 0U);
  settle();
  EXPECT_EQ(card(2).report().waiting, 0U);
  EXPECT_EQ(load(3, 1004), 4U);
  EXPECT_EQ(load(3, 2002), 2U);
}

TEST_F(Messages, ShorterThanARingOfBlocksStillPassOneAnother) {
  use_inserted(6, kBurst256);
  for (std::uint32_t node = 0; node < 6; ++node)
    for (std::uint32_t i = 0; i < 150; ++i) store(node, node * 200 + i, node * 1000 + i);
  settle();
  for (std::uint32_t at = 0; at < 6; ++at)
    for (std::uint32_t node = 0; node < 6; ++node)
      for (std::uint32_t i = 0; i < 150; ++i)
        ASSERT_EQ(load(at, node * 200 + i), node * 1000 + i) << at << " " << node;
}

}  // namespace
}  // namespace rths::test
