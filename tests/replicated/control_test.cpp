// SPDX-License-Identifier: Apache-2.0
//
// Control and status registers, and the transmit FIFO.
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

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
  acr(0, 1023, 1);
  EXPECT_EQ(card(0).acr(LongwordOffset{1023}), 1U);
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

}  // namespace
}  // namespace rths::test
