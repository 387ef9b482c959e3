// SPDX-License-Identifier: Apache-2.0
//
// Damaged messages, cut fibres, dead nodes; repetition in PLATINUM.
#include <cmath>

#include "virtual_cards.hpp"

namespace rths::test {
namespace {

class Faults : public VirtualCards {};

TEST_F(Faults, OfAFibreLoseMessagesBehindIt) {
  use_inserted(4);
  ring().set_fibre(1, false);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(load(1, 5), 1U);
  EXPECT_EQ(load(2, 5), 0U);
  EXPECT_EQ(load(3, 5), 0U);
  EXPECT_EQ(hops(Hop::Kind::Broken, 1).size(), 1U);
  ring().set_fibre(1, true);
  store(0, 6, 1);
  settle();
  EXPECT_EQ(load(3, 6), 1U);
}

TEST_F(Faults, OfPowerAreBypassedOnlyWithASwitch) {
  for (const bool has_switch : {true, false}) {
    RingSetup setup = nodes(3);
    setup.nodes[1].bypass_switch = has_switch;
    use_inserted(setup);
    card(1).set_power(false);
    EXPECT_EQ(store(1, 1, 1), Access::Local);
    store(0, 5, 1);
    settle();
    EXPECT_EQ(load(2, 5), has_switch ? 1U : 0U);
    EXPECT_EQ(csr(2, 1) & 0x40, has_switch ? 0U : 0x40U);
  }
}

TEST_F(Faults, OfBitsLoseAMessageSilentlyInBurst) {
  use_inserted(3);
  ring().set_bit_error_rate(1);
  store(0, 5, 1);
  settle();
  ring().set_bit_error_rate(0);
  store(0, 6, 1);
  settle();
  EXPECT_EQ(load(1, 5), 0U);
  EXPECT_EQ(load(2, 5), 0U);
  EXPECT_EQ(load(2, 6), 1U);
  EXPECT_EQ(csr(1, 1) & 0x680, 0x80U);
  EXPECT_EQ(csr(0, 1) & 0x600, 0U);
  EXPECT_EQ(card(0).report().sent, 2U);
  EXPECT_EQ(card(0).report().repeated, 0U);
}

TEST_F(Faults, OfBitsHaveTheRateThatIsSet) {
  use_inserted(2);
  ring().set_bit_error_rate(1e-3);
  constexpr int kMessages = 4000;
  for (int i = 0; i < kMessages; ++i) {
    store(0, 5, 1);
    settle();
  }
  const double p = 1 - std::pow(1 - 1e-3, 82);
  EXPECT_NEAR(static_cast<double>(card(1).report().rejected), kMessages * p,
              5 * std::sqrt(kMessages * p * (1 - p)));
}

TEST_F(Faults, OfBitsOfGtFramesHaveTheRateThatIsSet) {
  use(nodes(2, CardType::Gt));
  ring().set_bit_error_rate(1e-3);
  constexpr int kMessages = 20'000;
  for (int i = 0; i < kMessages; ++i) {
    store(0, 5, 1);
    settle();
  }
  const double p = 1 - std::pow(1 - 1e-3, 260);  // 26 bytes of 10 bits
  EXPECT_NEAR(static_cast<double>(card(1).report().rejected), kMessages * p,
              5 * std::sqrt(kMessages * p * (1 - p)));
}

TEST_F(Faults, OfBitsAreRepairedInPlatinumInOrder) {
  use_inserted(4, kPlatinum);
  csr(3, 0, 0x806B);
  csr(0, 0, 0x8303);
  ring().set_bit_error_rate(2e-3);
  for (std::uint32_t i = 1; i <= 500; ++i) store(0, 5, i);
  std::uint32_t last = 0;
  while (!ring().run_until_idle(ring().now() + 100ns)) {
    EXPECT_GE(load(3, 5), last);
    last = load(3, 5);
  }
  EXPECT_EQ(load(3, 5), 500U);
  EXPECT_GT(card(0).report().repeated, 100U);
  EXPECT_EQ(card(0).report().sent, 500U);
  EXPECT_EQ(csr(0, 1) & 0x607, 0x200U);  // none after a time-out; the FIFO is empty
  // A receiver sees repetitions of messages that it had: marked in CSR5.
  std::uint32_t repeated = 0, all = 0;
  for (std::uint32_t high = csr(3, 5); (high & 0x8000) != 0; high = csr(3, 5)) {
    repeated += (high & 0x4000) != 0 ? 1 : 0;
    ++all;
    EXPECT_EQ(csr(3, 4), 20U);
  }
  EXPECT_GT(all, 500U);
  EXPECT_GT(repeated, 0U);
}

TEST_F(Faults, OfTheRingMakePlatinumRepeatAfterTheTimeOut) {
  use_inserted(3, kPlatinum);
  csr(0, 5, 10);
  ring().set_fibre(2, false);
  store(0, 5, 1);
  pass(50us);
  // A period is the message and ten units of 240 ns.
  const double period = kMessageNs + 10 * 36 * kBitNs;
  EXPECT_NEAR(static_cast<double>(card(0).report().repeated), 50'000 / period, 1);
  EXPECT_EQ(csr(0, 1), 0x440U);  // and no carrier
  ring().set_fibre(2, true);
  settle();
  EXPECT_EQ(csr(0, 1) & 2, 0U);
}

TEST_F(Faults, OfPowerForgetTheMessageThatWasNotReturned) {
  use_inserted(2, kPlatinum);
  ring().set_fibre(1, false);
  store(0, 5, 1);
  pass(1us);
  card(0).set_power(false);
  ring().set_fibre(1, true);
  card(0).set_power(true);
  csr(0, 2, kPlatinum);
  csr(0, 0, kOnRing);
  store(0, 6, 2);
  settle();
  EXPECT_EQ(load(1, 6), 2U);
  EXPECT_EQ(card(0).report().repeated, 0U);
}

// The loop takes 5.8 µs, the time-out 2.4 µs. The copy of the first message that returns during
// the second one does not confirm it: the third waits for the second.
TEST_F(Faults, OfTheTimeOutDoNotMakeAnOldCopyConfirmTheNextMessage) {
  RingSetup setup = nodes(2);
  setup.nodes[0].fibre_m = setup.nodes[1].fibre_m = 500;
  use_inserted(setup, kPlatinum);
  csr(0, 5, 10);
  for (std::uint32_t i = 1; i <= 3; ++i) store(0, i, i);
  settle();
  const auto sent = hops(Hop::Kind::Inserted, 0);
  ASSERT_EQ(sent.size(), 3U);
  const double loop = kMessageNs + kNodeNs + 2 * 500 * kMetreNs;
  for (std::size_t i = 1; i < 3; ++i)
    EXPECT_GE(to_ns(sent[i].begin - sent[i - 1].begin), loop - kTickNs);
  EXPECT_EQ(card(0).report().repeated, 3U);
}

TEST_F(Faults, AreCountedByCsr13) {
  use_inserted(2);
  ring().set_bit_error_rate(1);
  for (int i = 0; i < 5; ++i) store(0, 5, 1);
  settle();
  EXPECT_EQ(csr(1, 13), 5U);
}

TEST_F(Faults, OfBlocksLoseTheWholeBlock) {
  use_inserted(3, kBurst256);
  ring().set_bit_error_rate(1);
  for (std::uint32_t i = 0; i < 100; ++i) store(0, i, 1);
  settle();
  EXPECT_EQ(load(1, 50), 0U);
  EXPECT_EQ(card(2).report().rejected, card(0).report().sent);
}

TEST_F(Faults, OfBlocksAreRepairedInPlatinum) {
  use_inserted(3, 0x5040);
  csr(0, 5, 100);
  ring().set_bit_error_rate(1e-4);
  for (std::uint32_t i = 0; i < 1000; ++i) store(0, i, i);
  settle();
  for (std::uint32_t i = 0; i < 1000; ++i) ASSERT_EQ(load(2, i), i);
  EXPECT_GT(card(0).report().repeated, 0U);
}

}  // namespace
}  // namespace rths::test
