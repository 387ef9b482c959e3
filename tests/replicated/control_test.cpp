// SPDX-License-Identifier: Apache-2.0
//
// Control and status registers, modes of the card and its data paths.
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

class Control : public VirtualCards {
 protected:
  // CSR1.1: whether the transmit FIFO holds anything.
  bool has_queued(std::uint32_t node) { return (csr(node, 1) & 2) != 0; }
};

TEST_F(Control, HasThePowerUpValuesOfTheManual) {
  use(nodes(1));
  EXPECT_EQ(csr(0, 0), 0U);
  EXPECT_EQ(csr(0, 2), 0xC040U);
  EXPECT_EQ(csr(0, 3), 0x0100U);
  EXPECT_EQ(csr(0, 5), 0U);
  EXPECT_EQ(csr(0, 8), 0x8800U | 3U << 12);
  EXPECT_EQ(csr(0, 9), 0x0029U);
  EXPECT_EQ(csr(0, 10), 1U);
  EXPECT_EQ(csr(0, 11), 0x80U);
  EXPECT_EQ(csr(0, 12), 0U);
  EXPECT_EQ(csr(0, 13), 0U);
  EXPECT_EQ(csr(0, 15), 0x20U);
}

TEST_F(Control, ShowsTheSizeOfItsMemory) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kSizes[] = {
      {8U << 20, 1},   {4U << 20, 2},   {2U << 20, 3}, {1U << 20, 4},
      {512U << 10, 5}, {128U << 10, 6}, {4U << 10, 7}, {2U << 10, 7}};
  for (const auto& [bytes, code] : kSizes) {
    RingSetup setup = nodes(1);
    setup.nodes[0].memory_bytes = bytes;
    use(setup);
    EXPECT_EQ(csr(0, 8), 0x8800U | code << 12);
    csr(0, 8, 0);
    EXPECT_EQ(csr(0, 8), 0x8000U | code << 12);
    EXPECT_EQ(store_bytes(0, bytes - 4, 7, 4), Access::Local);
    EXPECT_EQ(card(0).read(ByteOffset{bytes - 4}), 7U);
    EXPECT_EQ(card(0).read(ByteOffset{bytes}), 0xFFFF'FFFFU);
  }
}

TEST_F(Control, RoundsAccessesDownToTheirSizeAndEndsAtItsMemory) {
  RingSetup setup = nodes(1);
  setup.nodes[0].memory_bytes = 4096;
  use(setup);
  store_bytes(0, 4095, 0x1122'3344, 4);
  EXPECT_EQ(card(0).read(ByteOffset{4092}), 0x1122'3344U);
  EXPECT_EQ(card(0).read(ByteOffset{4095}, 2), 0x1122U);
  store_bytes(0, 4096, 1, 4);
  EXPECT_EQ(card(0).read(ByteOffset{4096}), 0xFFFF'FFFFU);
  acr(0, 1024, 1);
  EXPECT_EQ(card(0).acr(LongwordOffset{1024}), 0xFFU);
}

TEST_F(Control, ResetsItsRegistersByCsr8) {
  use_inserted(1);
  csr(0, 3, 0x4400);
  csr(0, 9, 0xFFFF);
  csr(0, 10, 0x1234);
  csr(0, 11, 0x5678);
  csr(0, 12, 0x9ABD);
  EXPECT_EQ(csr(0, 9), 0xFFFFU);
  EXPECT_EQ(csr(0, 10), 0x1234U);
  EXPECT_EQ(csr(0, 11), 0x5678U);
  EXPECT_EQ(csr(0, 12), 0x9ABDU);
  csr(0, 1, 0);
  csr(0, 8, 0x100);
  EXPECT_EQ(csr(0, 0), 0U);
  EXPECT_EQ(csr(0, 3), 0x4400U);
  EXPECT_EQ(csr(0, 8), 0x8800U | 3U << 12);
  EXPECT_EQ(csr(0, 9), 0x29U);
  EXPECT_EQ(csr(0, 10), 1U);
  EXPECT_EQ(csr(0, 12), 0U);
  EXPECT_EQ(csr(0, 1) & 0x4000, 0U);
}

TEST_F(Control, KeepsStateUntilPowerIsOff) {
  use_inserted(2);
  store(0, 3, 4);
  acr(0, 3, 1);
  csr(0, 12, 0);
  settle();
  pass(1s);
  EXPECT_EQ(load(0, 3), 4U);
  EXPECT_EQ(csr(0, 0), kOnRing);
  card(0).set_power(false);
  card(0).set_power(true);
  EXPECT_EQ(load(0, 3), 0U);
  EXPECT_EQ(csr(0, 0), 0U);
  EXPECT_EQ(card(0).acr(LongwordOffset{3}), 0U);
}

TEST_F(Control, IgnoresIndicesWithoutARegister) {
  use(nodes(1));
  for (const int index : {6, 7, 11, 14, 15, 16, 40, -1}) {
    csr(0, index, 0);
    static_cast<void>(csr(0, index));
  }
  EXPECT_EQ(csr(0, 16), 0U);
  EXPECT_EQ(csr(0, -1), 0U);
  EXPECT_EQ(csr(0, 0), 0U);
}

TEST_F(Control, ReadsLatchedBitsOnceUnlessTheirCausePersists) {
  use_inserted(2);
  csr(0, 0, 0x8001);
  for (std::uint32_t i = 0; i < 900; ++i) store(0, i, i);
  EXPECT_EQ(csr(0, 1) & 0x1FFF, 6U);
  EXPECT_EQ(csr(0, 1) & 0x1FFF, 6U);  // still at seven eighths
  csr(0, 0, 0x8003);
  settle();
  EXPECT_EQ(csr(0, 1) & 0x1FFF, 0U);
  csr(0, 0, 0x8001);
  for (std::uint32_t i = 0; i < 900; ++i) store(0, i, i);
  csr(0, 0, 0x8003);
  settle();
  EXPECT_EQ(card(0).peek_csr(1) & 0x1FFF, 4U);  // looking clears nothing
  EXPECT_EQ(csr(0, 1) & 0x1FFF, 4U);            // was at seven eighths
  EXPECT_EQ(csr(0, 1) & 0x1FFF, 0U);
}

TEST_F(Control, ArmsOnAnyWriteOfCsr1) {
  use(nodes(1));
  EXPECT_EQ(csr(0, 1) & 0x4000, 0U);
  csr(0, 1, 0);
  EXPECT_EQ(csr(0, 1) & 0x4000, 0x4000U);
}

TEST_F(Control, ShowsTheTransmitFifoWhileItHoldsAnything) {
  use_inserted(2);
  csr(0, 0, 0x8001);
  EXPECT_FALSE(has_queued(0));
  store(0, 1, 1);
  pass(1ms);
  EXPECT_TRUE(has_queued(0));
  csr(0, 0, 0x8003);
  settle();
  EXPECT_FALSE(has_queued(0));
}

TEST_F(Control, EmptiesFifosOnTheirResetBits) {
  use_inserted(2);
  csr(1, 0, 0x8161);  // receives only; every message interrupts
  csr(0, 0, 0x8303);
  store(0, 1, 1);
  store(1, 2, 2);
  settle();
  EXPECT_TRUE(has_queued(1));
  EXPECT_NE(csr(1, 5) & 0x8000, 0U);
  csr(1, 0, 0xF000);
  EXPECT_EQ(csr(1, 0), 0xF000U);
  csr(1, 0, 0x8003);
  EXPECT_FALSE(has_queued(1));
  EXPECT_EQ(csr(1, 5) & 0x8000, 0U);
  settle();
  EXPECT_EQ(load(0, 2), 0U);
}

TEST_F(Control, SendsQueuedStoresInOrderWhenTransmitIsEnabled) {
  use_inserted(2);
  csr(0, 0, 0x8001);
  for (std::uint32_t i = 0; i < 50; ++i) store(0, 7, i);
  store(0, 8, 1);
  pass(1ms);
  EXPECT_EQ(load(1, 7), 0U);
  csr(0, 0, 0x8003);
  settle();
  EXPECT_EQ(load(1, 7), 49U);
  EXPECT_EQ(hops(Hop::Kind::Stored, 1).size(), 51U);
}

TEST_F(Control, IsolatesANodeWithReceiveAndTransmitOff) {
  use_inserted(3);
  csr(1, 0, 0x8000);
  store(1, 1, 5);
  store(0, 2, 6);
  settle();
  csr(1, 0, 0x8003);
  settle();
  EXPECT_EQ(load(1, 1), 5U);
  EXPECT_EQ(load(1, 2), 0U);
  EXPECT_EQ(load(0, 1), 0U);
  EXPECT_EQ(load(2, 2), 6U);
}

TEST_F(Control, TransmitsOnlyAndStillPassesMessagesOn) {
  use_inserted(3);
  csr(1, 0, 0x8002);
  store(1, 1, 5);
  store(0, 2, 6);
  settle();
  EXPECT_EQ(load(0, 1), 5U);
  EXPECT_EQ(load(1, 2), 0U);
  EXPECT_EQ(load(2, 2), 6U);
}

TEST_F(Control, SendsNothingWithATimeOutOfZero) {
  use_inserted(2);
  csr(0, 5, 0);
  store(0, 1, 5);
  pass(10ms);
  EXPECT_EQ(load(1, 1), 0U);
  EXPECT_TRUE(has_queued(0));
  for (std::uint32_t i = 1; i < 1024; ++i) EXPECT_EQ(store(0, 1, i), Access::Queued);
  EXPECT_EQ(store(0, 1, 9999), Access::HeldOff);
  EXPECT_EQ(csr(0, 5), 0U);
  csr(0, 5, 16);
  settle();
  EXPECT_EQ(load(1, 1), 1023U);
}

TEST_F(Control, LosesStoresBeyondAFullFifoWithoutHoldoff) {
  use_inserted(2);
  csr(0, 0, 0x8001);
  csr(0, 8, csr(0, 8) | 2);
  for (std::uint32_t i = 0; i < 1024; ++i) EXPECT_EQ(store(0, i, 1), Access::Queued);
  EXPECT_EQ(store(0, 1024, 1), Access::Lost);
  EXPECT_EQ(load(0, 1024), 1U);
  csr(0, 0, 0x8003);
  settle();
  EXPECT_EQ(load(1, 1023), 1U);
  EXPECT_EQ(load(1, 1024), 0U);
}

TEST_F(Control, ShowsReceiveIdAndAgeThroughTheMultiplexer) {
  use_inserted(2);
  EXPECT_EQ(csr(0, 3) >> 8, 1U);
  csr(0, 3, 0x2A00);
  EXPECT_EQ(csr(0, 3) >> 8, 0x2AU);
  csr(0, 8, csr(0, 8) | 1);
  EXPECT_EQ(csr(0, 3), 0x2A00U);
  csr(0, 3, 0x3307);
  EXPECT_EQ(csr(0, 3), 0x3307U);
  csr(0, 8, csr(0, 8) & ~1U);
  EXPECT_EQ(csr(0, 3) >> 8, 0x2AU);
}

TEST_F(Control, IsHealthyOnAClosedRingAndShowsTheLossOfCarrier) {
  use_inserted(3);
  for (std::uint32_t node = 0; node < 3; ++node) store(node, node, 1);
  settle();
  for (std::uint32_t node = 0; node < 3; ++node) {
    EXPECT_EQ(card(node).peek_csr(1), 0U);
    EXPECT_EQ(csr(node, 1), 0U);
  }
  ring().set_fibre(0, false);
  EXPECT_EQ(csr(1, 1) & 0x40, 0x40U);
  EXPECT_EQ(csr(1, 1) & 0x40, 0x40U);
  EXPECT_EQ(csr(2, 1) & 0x40, 0U);
  ring().set_fibre(0, true);
  EXPECT_EQ(csr(1, 1) & 0x40, 0U);
}

TEST_F(Control, HasACarrierFromItselfWhenItIsAlone) {
  use(nodes(2));  // none is in the ring
  EXPECT_EQ(csr(0, 1) & 0x40, 0x40U);
  use_inserted(1);
  EXPECT_EQ(csr(0, 1) & 0x40, 0U);
  ring().set_fibre(0, false);
  EXPECT_EQ(csr(0, 1) & 0x40, 0x40U);
}

TEST_F(Control, ReportsThatThereIsNoBypassSwitch) {
  RingSetup setup = nodes(2);
  setup.nodes[1].bypass_switch = false;
  use_inserted(setup);
  EXPECT_EQ(csr(0, 1) & 0x8000, 0U);
  EXPECT_EQ(csr(1, 1) & 0x8000, 0x8000U);
}

TEST_F(Control, ReadsAnOwnStoreBackAtOnce) {
  use_inserted(2);
  store(0, 3, 4);
  EXPECT_EQ(load(0, 3), 4U);
}

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
