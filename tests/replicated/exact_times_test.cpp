// SPDX-License-Identifier: Apache-2.0
//
// Times to the tick and lengths to the longword.
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

class ExactTimes : public VirtualCards {
 protected:
  std::vector<std::uint32_t> lengths_of_blocks(std::uint32_t node) const {
    std::vector<std::uint32_t> lengths;
    for (const Hop& hop : hops(Hop::Kind::Inserted, node)) lengths.push_back(hop.longwords);
    return lengths;
  }
};

using Lengths = std::vector<std::uint32_t>;

// 82 bits of 100 ticks, and 10 m of fibre of 75 ticks.
constexpr Time kFirstArrival{82 * 100 + 750};

TEST_F(ExactTimes, OfArrivalFollowFromBitsAndFibre) {
  use_inserted(2);
  store(0, 5, 1);
  store(0, 9, 2);
  ring().run_until(kFirstArrival - Time{1});
  EXPECT_EQ(load(1, 5), 0U);
  EXPECT_EQ(ring().next_event(), kFirstArrival);
  ring().run_until(kFirstArrival);
  EXPECT_EQ(load(1, 5), 1U);
  EXPECT_EQ(ring().now(), kFirstArrival);
  const auto stored = [&] { return hops(Hop::Kind::Stored, 1); };
  settle();
  ASSERT_EQ(stored().size(), 2U);
  EXPECT_EQ(stored()[1].begin, kFirstArrival + Time{92 * 100});
}

// The second message of node 0 is ready when the first own one of node 1 may start.
TEST_F(ExactTimes, OfAFirstOwnMessageLetOneOtherPass) {
  use_inserted(3);
  store(0, 5, 1);
  store(0, 6, 2);
  ring().run_until(kFirstArrival);
  store(1, 7, 3);
  settle();
  const auto stored = hops(Hop::Kind::Stored, 2);
  ASSERT_EQ(stored.size(), 3U);
  EXPECT_EQ(stored[0].origin, 0U);
  EXPECT_EQ(stored[1].origin, 0U);
  EXPECT_EQ(stored[2].origin, 1U);
}

TEST_F(ExactTimes, OfAnIdleRingIncludeTheLimit) {
  use_inserted(1);
  store(0, 5, 1);
  const Time end = kFirstArrival;  // it has returned to its only node
  EXPECT_FALSE(ring().run_until_idle(end - Time{1}));
  EXPECT_EQ(ring().now(), end - Time{1});
  EXPECT_TRUE(ring().run_until_idle(end));
  EXPECT_EQ(ring().now(), end);
}

TEST_F(ExactTimes, OfGtFramesFollowFromBytesAndFibre) {
  use(nodes(3, CardType::Gt));
  store(0, 5, 1);
  store(0, 9, 2);
  settle();
  const auto stored = hops(Hop::Kind::Stored, 1), passed = hops(Hop::Kind::Passed, 1);
  ASSERT_EQ(stored.size(), 2U);
  // 350 ns, 26 bytes of 60 ticks, fibre; the next frame is 30 bytes behind.
  EXPECT_EQ(stored[0].begin, Time{350 * 15 + 26 * 60 + 750});
  EXPECT_EQ(stored[1].begin, stored[0].begin + Time{30 * 60});
  EXPECT_EQ(passed[0].begin, Time{350 * 15 + 750 + 450 * 15});
}

TEST_F(ExactTimes, OfBlocksFollowTheirGreatestLengths) {
  use_inserted(2, kBurst1024);
  for (std::uint32_t i = 0; i < 600; ++i) store(0, i, i);
  settle();
  EXPECT_EQ(lengths_of_blocks(0), (Lengths{256, 256, 88}));
  const Hop last = hops(Hop::Kind::Inserted, 0).back();
  EXPECT_EQ(last.end - last.begin, Time{(46 + 88 * 36) * 100});
  use_inserted(2, kBurst256);
  for (std::uint32_t i = 0; i < 100; ++i) store(0, i, i);
  settle();
  EXPECT_EQ(hops(Hop::Kind::Stored, 1).back().longwords, 36U);
  EXPECT_EQ(card(0).report().sent, 2U);
  use_inserted(2, kBurst | 0x800);  // the length alone makes no blocks
  for (std::uint32_t i = 0; i < 4; ++i) store(0, i, i);
  settle();
  EXPECT_EQ(card(0).report().sent, 4U);
}

TEST_F(ExactTimes, OfGtBlocksFollow32Longwords) {
  use(nodes(2, CardType::Gt));
  for (std::uint32_t i = 0; i < 64; ++i) store(0, i, i);
  settle();
  EXPECT_EQ(lengths_of_blocks(0), (Lengths{32, 32}));
}

TEST_F(ExactTimes, OfGtBlocksEndAtBytesAndInterrupts) {
  use(nodes(2, CardType::Gt));
  store(1, 1, 0x1122'3344);
  store(1, 3, 0x5566'7788);
  settle();
  card(1).set_gt_state(6, 0xFFFF'FFFF);
  store(0, 0, 1);
  store_bytes(0, 4, 0xAA, 1);
  store(0, 2, 3);
  card(0).send_interrupt(1, 12, 9);  // as if it were the word at address 12
  settle();
  EXPECT_EQ(load(1, 1), 0x1122'33AAU);
  EXPECT_EQ(load(1, 2), 3U);
  EXPECT_EQ(load(1, 3), 0x5566'7788U);
  EXPECT_EQ(card(1).take_interrupt()->id, 12U);
}

TEST_F(ExactTimes, OfATimeOutCountFromTheLastBit) {
  use_inserted(2, kPlatinum);
  ring().set_fibre(1, false);
  store(0, 5, 1);
  pass(20us);
  const auto repeated = hops(Hop::Kind::Repeated, 0);
  ASSERT_GE(repeated.size(), 2U);
  // 82 bits and 16 units of 36 bits.
  EXPECT_EQ(repeated[0].begin, Time{(82 + 16 * 36) * 100});
  EXPECT_EQ(repeated[1].begin - repeated[0].begin, repeated[0].begin);
  EXPECT_EQ(csr(0, 1) & 0x600, 0x400U);
  csr(0, 0, kOnRing | 0x4000);
  csr(0, 0, kOnRing);  // forgets the message
  const std::uint64_t before = card(0).report().repeated;
  pass(20us);
  EXPECT_EQ(card(0).report().repeated, before);
}

// Longwords that follow in the FIFO do not join a block that is sent again.
TEST_F(ExactTimes, AndLengthOfARepeatedBlockAreItsFirst) {
  use_inserted(2, 0x5040);
  csr(0, 5, 0x100);
  ring().set_bit_error_rate(1);
  for (std::uint32_t i = 0; i < 10; ++i) store(0, i, i);
  pass(2900ns);  // 46 and 360 bits have been sent
  ring().set_bit_error_rate(0);
  for (std::uint32_t i = 10; i < 20; ++i) store(0, i, i);
  settle();
  const auto repeated = hops(Hop::Kind::Repeated, 0);
  ASSERT_EQ(repeated.size(), 1U);
  EXPECT_EQ(repeated[0].longwords, 10U);
  EXPECT_EQ(lengths_of_blocks(0), (Lengths{10, 10}));
  EXPECT_EQ(load(1, 19), 19U);
}

TEST_F(ExactTimes, OfARepetitionAfterAnErrorNeedNoTimeOut) {
  use_inserted(3, kPlatinum);
  ring().set_bit_error_rate(1);
  store(0, 5, 1);
  pass(1us);
  ring().set_bit_error_rate(0);
  settle();
  EXPECT_EQ(csr(0, 1) & 0x600, 0x200U);
  EXPECT_EQ(card(0).report().repeated, 1U);
  EXPECT_EQ(load(2, 5), 1U);
  EXPECT_EQ(csr(0, 3) & 0xFF, 3U);
}

TEST_F(ExactTimes, OfTheCounterAreItsTicks) {
  use(nodes(1));
  csr(0, 8, 0x800 | 0x200);
  csr(0, 9, 0x4000);
  csr(0, 13, 0);
  pass(replicated::from_ns(1.7e6));
  EXPECT_EQ(csr(0, 13), 63'765U);  // of 26.66 ns
  csr(0, 9, 0x2000);
  csr(0, 13, 0);
  pass(replicated::from_ns(50'000 * 1706.0));
  EXPECT_EQ(csr(0, 13), 50'000U);
  csr(0, 8, 0x800);  // stops it at its value
  csr(0, 9, 0);
  pass(1ms);
  EXPECT_EQ(csr(0, 13), 50'000U);
}

TEST_F(ExactTimes, OfAWrappedCounterShowInCsr1) {
  use_inserted(1);
  csr(0, 8, 0x800 | 0x200);
  csr(0, 9, 0x4000);
  csr(0, 13, 0);
  pass(replicated::from_ns(0x1'0000 * 26.66 - 30));
  EXPECT_EQ(csr(0, 1), 0U);
  pass(60ns);
  EXPECT_EQ(csr(0, 1), 0x1000U);
  EXPECT_EQ(csr(0, 1), 0U);
  EXPECT_LT(csr(0, 13), 3U);
}

TEST_F(ExactTimes, OfTheSlowCounterBeginAtTriggerTwo) {
  use_inserted(2);
  csr(1, 8, 0x800 | 0x200);
  csr(1, 9, 0x4000);
  acr(1, 5, 0x8);
  csr(1, 13, 0);
  pass(100us);
  store(0, 5, 1);
  settle();
  EXPECT_GT(csr(1, 13), 3000U);
  acr(1, 5, 0x4);  // trigger 1 clears none
  csr(1, 9, 0x2000);
  csr(1, 13, 0);
  pass(10ms);
  EXPECT_EQ(card(1).write(ByteOffset{20}, 1), Access::Queued);
  EXPECT_GT(csr(1, 13), 5000U);
  EXPECT_EQ(card(1).report().triggers, 2U);
}

}  // namespace
}  // namespace rths::test
