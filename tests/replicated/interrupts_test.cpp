// SPDX-License-Identifier: Apache-2.0
//
// Interrupts of SCRAMNet+ cards.
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

class VirtualInterrupts : public VirtualCards {
 protected:
  // Node 0 sends interrupts for all words, node 1 receives those of all words.
  void use_pair() {
    use_inserted(2);
    csr(0, 0, 0x8303);
    csr(1, 0, 0x806B);
    csr(1, 1, 0);
  }
};

TEST_F(VirtualInterrupts, FollowTheRuleOfTheOutgoingBit) {
  for (std::uint32_t bits = 0; bits < 8; ++bits) {
    const bool tie = (bits & 1) != 0, otf = (bits & 2) != 0, nie = (bits & 4) != 0;
    use_inserted(2);
    csr(1, 0, 0x806B);
    csr(0, 0, kOnRing | (otf ? 0x200U : 0U) | (nie ? 0x100U : 0U));
    acr(0, 5, tie ? 2 : 0);
    store(0, 5, 1);
    settle();
    EXPECT_EQ(load(1, 5), 1U);
    EXPECT_EQ(interrupts(1), nie && (otf || tie) ? 1U : 0U) << bits;
  }
}

TEST_F(VirtualInterrupts, FollowTheRuleOfAcceptance) {
  for (std::uint32_t bits = 0; bits < 8; ++bits) {
    const bool rie = (bits & 1) != 0, orf = (bits & 2) != 0, imme = (bits & 4) != 0;
    use_inserted(2);
    csr(0, 0, 0x8303);
    csr(1, 0, kOnRing | (orf ? 0x40U : 0U) | (imme ? 0x20U : 0U));
    acr(1, 5, rie ? 1 : 0);
    store(0, 5, 1);
    settle();
    EXPECT_EQ(load(1, 5), 1U);
    EXPECT_EQ(interrupts(1), imme && (orf || rie) ? 1U : 0U) << bits;
  }
}

TEST_F(VirtualInterrupts, ComeFromEveryMessageIfCsr8SaysSo) {
  use_inserted(2);
  csr(1, 0, 0x8063);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(interrupts(1), 0U);
  csr(1, 8, csr(1, 8) | 0x400);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(interrupts(1), 1U);
}

TEST_F(VirtualInterrupts, GiveAddressesInOrderOfArrival) {
  use_pair();
  for (const std::uint32_t word : {9U, 3U, 0x7FFFFU, 3U}) store(0, word, word);
  settle();
  EXPECT_EQ(csr(1, 5), 0x8000U);  // not repeated
  for (const std::uint32_t word : {9U, 3U, 0x7FFFFU, 3U}) EXPECT_EQ(interrupt(1), 4 * word);
  EXPECT_EQ(interrupt(1), -1);
}

TEST_F(VirtualInterrupts, CountEveryAccessOfTheHost) {
  use_pair();
  for (std::uint32_t byte = 0; byte < 4; ++byte) store_bytes(0, 20 + byte, 1, 1);
  for (std::uint32_t half = 0; half < 2; ++half) store_bytes(0, 24 + 2 * half, 1, 2);
  store(0, 7, 1);
  settle();
  EXPECT_EQ(interrupts(1), 7U);
}

TEST_F(VirtualInterrupts, GiveTheAddressOnTheRing) {
  RingSetup setup = nodes(2);
  setup.nodes[1].memory_bytes = 4096;
  use_inserted(setup);
  csr(0, 0, 0x8303);
  csr(1, 0, 0x806B);
  csr(1, 12, 3 << 5 | 1);
  store(0, 3 * 1024 + 2, 1);
  store(0, 2, 1);
  store(0, 4 * 1024, 1);
  settle();
  EXPECT_EQ(interrupt(1), 3 * 4096 + 8);
  EXPECT_EQ(interrupt(1), -1);
}

TEST_F(VirtualInterrupts, FillTheFifoAndKeepItsOldestEntries) {
  use_pair();
  std::uint32_t written = 0;
  const auto write_until = [&](std::uint32_t count) {
    while (written < count) {
      store(0, written, written + 1);
      ++written;
      settle();
    }
  };
  write_until(1023);
  EXPECT_EQ(csr(1, 1) & 0x10, 0U);
  write_until(1024);
  EXPECT_EQ(csr(1, 1) & 0x10, 0x10U);
  EXPECT_EQ(csr(1, 1) & 0x10, 0x10U);  // still full
  write_until(1100);
  EXPECT_EQ(load(1, 1099), 1100U);
  EXPECT_EQ(card(1).report().lost_interrupts, 76U);
  for (std::int64_t entry = 0; entry < 1023; ++entry) ASSERT_EQ(interrupt(1), 4 * entry);
  EXPECT_EQ(interrupt(1), 4 * 1099);
  EXPECT_EQ(interrupt(1), -1);
}

TEST_F(VirtualInterrupts, ShowAFifoThatWasFullOnce) {
  use_pair();
  for (std::uint32_t i = 0; i < 1024; ++i) {
    store(0, i, 1);
    settle();
  }
  EXPECT_EQ(interrupts(1), 1024U);
  EXPECT_EQ(csr(1, 1) & 0x10, 0x10U);
  EXPECT_EQ(csr(1, 1) & 0x10, 0U);
}

TEST_F(VirtualInterrupts, ReachTheHostOncePerArming) {
  use_pair();
  store(0, 1, 1);
  store(0, 2, 1);
  settle();
  EXPECT_EQ(card(1).report().host_interrupts, 1U);
  EXPECT_EQ(csr(1, 1) & 0x4000, 0U);
  csr(1, 1, 0);  // entries are queued: fires again
  EXPECT_EQ(card(1).report().host_interrupts, 2U);
  EXPECT_EQ(interrupts(1), 2U);
  csr(1, 1, 0);
  EXPECT_EQ(card(1).report().host_interrupts, 2U);
  EXPECT_EQ(csr(1, 1) & 0x4000, 0x4000U);
}

TEST_F(VirtualInterrupts, AreNotLostBetweenTheEmptyFifoAndArming) {
  use_pair();
  store(0, 1, 1);
  settle();
  EXPECT_EQ(interrupts(1), 1U);
  store(0, 2, 1);  // arrives before the host arms
  settle();
  EXPECT_EQ(card(1).report().host_interrupts, 1U);
  csr(1, 1, 0);
  EXPECT_EQ(card(1).report().host_interrupts, 2U);
}

TEST_F(VirtualInterrupts, ComeWithTheirDataInMemory) {
  use_pair();
  for (std::uint32_t i = 1; i < 100; ++i) {
    store(0, 5, i);
    while (interrupt(1) < 0) pass(1ns);
    EXPECT_EQ(load(1, 5), i);
    csr(1, 1, 0);
  }
}

TEST_F(VirtualInterrupts, NeedTheHostsEnableToReachIt) {
  use_pair();
  csr(1, 0, 0x8063);
  store(0, 1, 1);
  settle();
  EXPECT_EQ(card(1).report().host_interrupts, 0U);
  EXPECT_EQ(interrupts(1), 1U);
}

TEST_F(VirtualInterrupts, OfOwnStoresNeedBothBits) {
  for (std::uint32_t bits = 0; bits < 4; ++bits) {
    use_inserted(2, kBurst | bits << 9);
    csr(0, 0, 0x836B);
    store(0, 5, 1);
    settle();
    EXPECT_EQ(interrupts(0), bits == 3 ? 1U : 0U) << bits;
  }
}

TEST_F(VirtualInterrupts, OfErrorsShowAnEmptyFifoAndTheirCondition) {
  use_inserted(2);
  csr(1, 9, 0x80);  // bad messages
  csr(1, 0, 0x808B);
  csr(1, 1, 0);
  ring().set_bit_error_rate(1);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(card(1).report().host_interrupts, 1U);
  EXPECT_EQ(csr(1, 5) & 0x8000, 0U);
  EXPECT_EQ(csr(1, 1) & 0x80, 0x80U);
  EXPECT_EQ(load(1, 5), 0U);
}

TEST_F(VirtualInterrupts, OfALostCarrierComeWhenTheFibreIsCut) {
  use_inserted(3);
  for (std::uint32_t node = 0; node < 3; ++node) {
    csr(node, 9, 0x40);
    csr(node, 0, 0x808B);
    csr(node, 1, 0);
  }
  ring().set_fibre(0, false);
  EXPECT_EQ(card(0).report().host_interrupts, 0U);
  EXPECT_EQ(card(1).report().host_interrupts, 1U);
  EXPECT_EQ(card(2).report().host_interrupts, 0U);
  static_cast<void>(csr(1, 1));
  ring().set_fibre(2, false);
  csr(1, 1, 0);
  ring().set_fibre(0, true);  // node 0 still has no carrier
  EXPECT_EQ(card(0).report().host_interrupts, 1U);
  EXPECT_EQ(card(1).report().host_interrupts, 2U);
}

TEST_F(VirtualInterrupts, OfErrorsNeedTheirMaskAndEnable) {
  for (std::uint32_t bits = 0; bits < 3; ++bits) {
    use_inserted(2);
    csr(1, 9, (bits & 1) != 0 ? 0x80 : 0);
    csr(1, 0, 0x800B | ((bits & 2) != 0 ? 0x80U : 0U));
    csr(1, 1, 0);
    ring().set_bit_error_rate(1);
    store(0, 5, 1);
    settle();
    EXPECT_EQ(card(1).report().host_interrupts, 0U) << bits;
  }
}

TEST_F(VirtualInterrupts, ComeFromEachLongwordOfABlock) {
  use_inserted(2, kBurst256);
  csr(1, 8, 0xC00);  // every message interrupts
  csr(1, 0, 0x806B);
  for (std::uint32_t word = 5; word < 25; ++word) store(0, word, 1);
  settle();
  EXPECT_EQ(card(0).report().sent, 1U);
  for (std::uint32_t word = 5; word < 25; ++word) EXPECT_EQ(interrupt(1), 4 * word);
  EXPECT_EQ(interrupt(1), -1);
}

TEST_F(VirtualInterrupts, EndABlock) {
  use_inserted(2, kBurst256);
  csr(0, 0, 0x8103);
  csr(1, 0, 0x806B);
  acr(0, 4, 2);
  for (std::uint32_t word = 0; word < 10; ++word) store(0, word, 1);
  settle();
  EXPECT_EQ(card(0).report().sent, 3U);
  EXPECT_EQ(interrupt(1), 16);
  EXPECT_EQ(interrupt(1), -1);
}

}  // namespace
}  // namespace rths::test
