// SPDX-License-Identifier: Apache-2.0
//
// Modes of a card: filter, write-me-last, HIPRO, paging, ACR, counter; its data paths.
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

TEST_F(Control, FiltersUnchangedStoresWhereItIsOn) {
  constexpr std::uint32_t kLow = 0x3FC / 4, kHigh = 0x1000 / 4;
  struct Case {
    std::uint32_t bits;
    bool low, high;  // filtered
  };
  for (const Case& filter : {Case{0, false, false}, Case{0x400, false, true},
                             Case{0xC00, true, true}, Case{0x800, false, false}}) {
    use_inserted(2);
    csr(0, 0, 0x8001 | filter.bits);
    for (const std::uint32_t word : {kLow, kHigh}) {
      csr(0, 0, csr(0, 0) | 0x4000);
      csr(0, 0, csr(0, 0) & ~0x4000U);
      EXPECT_EQ(store(0, word, 3), Access::Queued);  // changed
      EXPECT_TRUE(has_queued(0));
      csr(0, 0, csr(0, 0) | 0x4000);
      csr(0, 0, csr(0, 0) & ~0x4000U);
      const bool filtered = word == kLow ? filter.low : filter.high;
      EXPECT_EQ(store(0, word, 3), filtered ? Access::Filtered : Access::Queued);
      EXPECT_EQ(has_queued(0), !filtered);
    }
  }
}

TEST_F(Control, NeverFiltersInterruptWords) {
  use_inserted(2);
  csr(0, 0, 0x8103 | 0xC00);
  acr(0, 5, 2);
  store(0, 5, 0);
  store(0, 6, 0);
  settle();
  EXPECT_EQ(card(0).report().sent, 1U);
}

TEST_F(Control, WritesItselfLastInWriteMeLast) {
  use_inserted(3, kBurst | 0x300);
  store(0, 5, 9);
  EXPECT_EQ(load(0, 5), 0U);
  while (load(2, 5) == 0) pass(10ns);
  EXPECT_EQ(load(0, 5), 0U);
  settle();
  EXPECT_EQ(load(0, 5), 9U);
}

TEST_F(Control, NeverWritesItselfInWriteMeLastOnABrokenRing) {
  use_inserted(3, kBurst | 0x300);
  ring().set_fibre(2, false);
  store(0, 5, 9);
  settle();
  pass(1s);
  EXPECT_EQ(load(2, 5), 9U);
  EXPECT_EQ(load(0, 5), 0U);
}

TEST_F(Control, StoresNothingLocallyWithHostWritesOff) {
  use_inserted(2, kBurst | 0x100);
  store(0, 5, 9);
  settle();
  EXPECT_EQ(load(0, 5), 0U);
  EXPECT_EQ(load(1, 5), 9U);
}

TEST_F(Control, WithholdsHiProWordsUntilAllBytesAreWritten) {
  use_inserted(2, kBurst | 0x2000);
  acr(0, 5, 0x10);
  EXPECT_EQ(store_bytes(0, 22, 0x4433, 2), Access::Withheld);
  settle();
  EXPECT_EQ(load(0, 5), 0x4433'0000U);
  EXPECT_EQ(load(1, 5), 0U);
  EXPECT_EQ(store_bytes(0, 21, 0x22, 1), Access::Withheld);
  EXPECT_EQ(store_bytes(0, 20, 0x11, 1), Access::Queued);
  settle();
  EXPECT_EQ(load(1, 5), 0x4433'2211U);
  EXPECT_EQ(card(0).report().sent, 1U);
}

TEST_F(Control, RestartsHiProAtAStoreToAnotherWord) {
  use_inserted(2, kBurst | 0x2000);
  acr(0, 5, 0x10);
  store_bytes(0, 20, 0x1111, 2);
  EXPECT_EQ(store_bytes(0, 100, 1, 1), Access::Queued);  // no HIPRO word
  EXPECT_EQ(store_bytes(0, 22, 0x2222, 2), Access::Withheld);
  EXPECT_EQ(store_bytes(0, 20, 0x1111, 2), Access::Queued);
  EXPECT_EQ(store(0, 5, 3), Access::Queued);  // a whole longword
}

TEST_F(Control, MapsItsWindowToAPageOfTheRing) {
  RingSetup setup = nodes(2);
  setup.nodes[0].memory_bytes = 4096;
  use_inserted(setup);
  csr(0, 12, 3 << 5);  // paging is off
  store(0, 9, 6);
  settle();
  EXPECT_EQ(load(1, 9), 6U);
  csr(0, 12, 3 << 5 | 1);  // page 3 of 4 KiB
  store(0, 2, 7);
  store(1, 3 * 1024 + 5, 8);
  store(1, 5, 9);
  store(1, 4 * 1024, 10);
  settle();
  EXPECT_EQ(load(1, 3 * 1024 + 2), 7U);
  EXPECT_EQ(load(0, 5), 8U);
  EXPECT_EQ(load(0, 0), 0U);
}

TEST_F(Control, ShowsTheAcrInItsWindow) {
  use_inserted(2);
  store(0, 4, 77);
  settle();
  csr(0, 0, kOnRing | 0x10);
  EXPECT_EQ(store(0, 4, 0xFFFF'FFFF), Access::Local);
  EXPECT_EQ(load(0, 4), 0x1FU);
  store(1, 4, 78);
  settle();
  csr(0, 0, kOnRing);
  EXPECT_EQ(load(0, 4), 78U);
  EXPECT_EQ(card(0).acr(LongwordOffset{4}), 0x1FU);
}

TEST_F(Control, ClearsOnlyItsOwnCopyWhileInactive) {
  use_inserted(2);
  store(0, 4, 77);
  settle();
  csr(0, 0, 0);
  store(0, 4, 0);
  settle();
  EXPECT_EQ(load(0, 4), 0U);
  EXPECT_EQ(load(1, 4), 77U);
}

TEST_F(Control, CountsWhatItsModeSays) {
  use_inserted(3);
  csr(1, 9, 0x6000);  // messages
  csr(2, 9, 0x2000);  // triggers
  acr(2, 5, 0x8);
  acr(2, 6, 0x4);
  for (int i = 0; i < 7; ++i) store(0, 5, 1);
  settle();
  EXPECT_EQ(csr(1, 13), 7U);
  store(2, 6, 1);
  settle();
  EXPECT_EQ(csr(2, 13), 8U);
  EXPECT_EQ(card(2).report().triggers, 8U);
  csr(1, 13, 0xFFFE);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(csr(1, 13), 0xFFFFU);
  EXPECT_EQ(csr(1, 1) & 0x1000, 0U);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(csr(1, 13), 0U);
  EXPECT_EQ(csr(1, 1) & 0x1000, 0x1000U);
}

TEST_F(Control, RunsItsCounterInVirtualTime) {
  use(nodes(1));
  csr(0, 8, csr(0, 8) | 0x200);
  csr(0, 9, 0x4000);
  csr(0, 13, 0);
  pass(100us);
  EXPECT_NEAR(csr(0, 13) * 26.66, 100'000, 27);
  csr(0, 9, 0x2000);
  csr(0, 13, 0);
  pass(10ms);
  EXPECT_NEAR(csr(0, 13) * 1706.0, 10e6, 1707);
}

TEST_F(Control, ClearsItsSlowCounterByTriggerTwo) {
  use_inserted(2);
  csr(1, 8, csr(1, 8) | 0x200);
  csr(1, 9, 0x2000);
  csr(1, 13, 0);
  acr(1, 5, 0x8);
  pass(10ms);
  EXPECT_GT(csr(1, 13), 5000U);
  store(0, 5, 1);
  settle();
  EXPECT_LT(csr(1, 13), 2U);
}

TEST_F(Control, GivesNoTriggersForTheOtherBitsOfTheAcr) {
  use_inserted(2);
  acr(0, 5, 0x13);
  acr(1, 5, 0x13);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(card(0).report().triggers, 0U);
  EXPECT_EQ(card(1).report().triggers, 0U);
}

TEST_F(Control, RunsNoCounterWithoutAClock) {
  use_inserted(2);
  csr(0, 8, 0xA00);
  csr(0, 9, 0);
  pass(1ms);
  EXPECT_EQ(csr(0, 13), 0U);
  ring().set_bit_error_rate(1);
  store(1, 5, 1);  // errors do not count then
  settle();
  EXPECT_EQ(csr(0, 13), 0U);
}

TEST_F(Control, KeepsACounterWithAClockWhenAMessageReturns) {
  use_inserted(2);
  csr(0, 8, 0xA00);
  csr(0, 9, 0x4000);
  csr(0, 13, 0);
  pass(20us);
  store(0, 5, 1);
  settle();
  EXPECT_GE(csr(0, 13), 750U);  // of 26.66 ns
}

TEST_F(Control, GivesNoTriggersWhileInterruptsAreForced) {
  use_inserted(2);
  acr(1, 5, 0x8);
  csr(1, 0, kOnRing | 0x40);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(card(1).report().triggers, 0U);
}

TEST_F(Control, ReceivesWithoutSendingAsAMonitor) {
  use_inserted(3);
  csr(1, 0, 0x0003);
  store(0, 5, 1);
  store(1, 6, 1);
  settle();
  EXPECT_EQ(load(1, 5), 1U);
  EXPECT_EQ(load(2, 5), 1U);
  EXPECT_EQ(load(2, 6), 0U);
  EXPECT_EQ(card(1).report().passed, 0U);
}

TEST_F(Control, LoopsMessagesInsideTheCardInWireLoopback) {
  use_inserted(3);
  csr(1, 0, 0x0003);
  csr(1, 2, 0xC2C0);  // wire loopback, own messages received
  store(0, 5, 1);
  store(1, 6, 1);
  settle();
  ASSERT_EQ(card(1).report().stored, 1U);
  EXPECT_NEAR(to_ns(hops(Hop::Kind::Stored, 1)[0].begin), kMessageNs, 0.01);
  EXPECT_EQ(load(1, 5), 0U);
  EXPECT_EQ(load(2, 5), 1U);
  EXPECT_EQ(load(2, 6), 0U);
  EXPECT_EQ(csr(1, 3) & 0xFF, 1U);
  ring().set_fibre(0, false);
  EXPECT_EQ(csr(1, 1) & 0x40, 0U);  // hears itself
}

TEST_F(Control, LoopsThroughFibreOrSwitch) {
  for (const bool fibre : {true, false}) {
    use_inserted(2);
    csr(0, 2, fibre ? 0xC200 : 0xC240);
    if (!fibre) csr(0, 8, csr(0, 8) & ~0x800U);
    store(0, 6, 1);
    settle();
    EXPECT_EQ(card(0).report().stored, 1U);
    EXPECT_EQ(load(1, 6), 0U);
  }
}

TEST_F(Control, BreaksTheRingWithWireLoopbackOfAnInsertedNode) {
  use_inserted(3);
  csr(1, 2, 0xC0C0);
  store(0, 5, 1);
  settle();
  EXPECT_EQ(load(2, 5), 0U);
  EXPECT_EQ(hops(Hop::Kind::Broken, 1).size(), 1U);
}

}  // namespace
}  // namespace rths::test
