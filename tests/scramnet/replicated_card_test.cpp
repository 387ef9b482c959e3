// SPDX-License-Identifier: Apache-2.0
//
// The vendor's calls of this process on a replicated ring: mapping, registers, messages.
#include <algorithm>
#include <chrono>
#include <iterator>

#include "replicated_card.hpp"

namespace rths::test {
namespace {

using std::chrono::steady_clock;

TEST_F(ReplicatedCard, HasItsPowerUpValuesAndKeepsThemWhenItIsTaken) {
  EXPECT_EQ(at_start[0], 0);
  EXPECT_EQ(at_start[1] & ~CSR1_TXFNE, 0);
  EXPECT_EQ(at_start[2], 0xC040);
  EXPECT_EQ(at_start[3], 0x0200);
  EXPECT_EQ(at_start[5], 0);
  EXPECT_EQ(at_start[8], 0x8800 | 7 << 12);
  EXPECT_EQ(at_start[9], 0x0029);
  EXPECT_EQ(at_start[10], 1);
  EXPECT_EQ(at_start[12], 0);
  EXPECT_EQ(at_start[15], 0x20);
}

TEST_F(ReplicatedCard, IsMappedAndUnmappedInAnyOrder) {
  auto* const base = get_base_mem();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(scr_mem_mm(UNMAP), 0);
    EXPECT_EQ(scr_mem_mm(UNMAP), 0);
    EXPECT_EQ(get_base_mem(), nullptr);
    EXPECT_EQ(scr_acr_read(kWord), 0xFF);
    scr_acr_write(kWord, ACR_TIE);
    EXPECT_EQ(scr_reg_mm(UNMAP), 0);
    EXPECT_EQ(scr_reg_mm(MAP), 0);
    EXPECT_EQ(scr_mem_mm(MAP), 0);
    EXPECT_EQ(scr_mem_mm(MAP), 0);
    EXPECT_EQ(scr_acr_read(kWord), 0);
    EXPECT_EQ(get_base_mem(), get_base_mem());
    store(static_cast<std::uint32_t>(i) + 10);
    EXPECT_TRUE(arrives(static_cast<std::uint32_t>(i) + 10));
  }
  EXPECT_NE(base, nullptr);
}

TEST_F(ReplicatedCard, IgnoresIndicesWithoutARegister) {
  for (const int index : {6, 7, 14, 15, 16, 40, -1}) {
    set_csr(index, 0xFFFF);
    static_cast<void>(csr(index));
  }
  EXPECT_EQ(csr(SCR_CSR0), 0x8003);
  EXPECT_EQ(csr(SCR_CSR2), 0xC040);
  EXPECT_EQ(csr(16), 0);
  store(9);
  EXPECT_TRUE(arrives(9));
}

TEST_F(ReplicatedCard, SendsAStoreThroughAPointer) {
  store(7);
  EXPECT_TRUE(arrives(7));
  EXPECT_TRUE(soon([] { return watcher->read(LongwordOffset{kWord}) == 7; }));
}

TEST_F(ReplicatedCard, ReceivesTheWritesOfOtherNodes) {
  write(kOther, 1234);
  EXPECT_TRUE(comes(kOther, 1234));
}

TEST_F(ReplicatedCard, NeverShowsATornLongword) {
  std::uint32_t zeros = 0, ones = 0, torn = 0;
  const auto begin = steady_clock::now();
  const auto takes = [=](int ms) {
    return steady_clock::now() - begin < std::chrono::milliseconds{ms};
  };
  for (std::uint32_t i = 0; takes(50) || (ones == 0 && takes(2000)); ++i) {
    store(i / 64 % 2 == 0 ? 0 : 0xFFFF'FFFF);
    const std::uint32_t value = seen();
    ++(value == 0 ? zeros : value == 0xFFFF'FFFF ? ones : torn);
  }
  EXPECT_EQ(torn, 0U);
  EXPECT_GT(zeros, 0U);
  EXPECT_GT(ones, 0U);
}

TEST_F(ReplicatedCard, ReceivesTheWritesOfANodeInItsOrder) {
  write(kOther + 1, 0);
  ASSERT_TRUE(comes(kOther + 1, 0));
  std::uint32_t changes = 0, i = 0;  // flags that were seen before the last write
  while (i < 500 || (changes == 0 && i < 20'000)) {
    write(kOther, ++i);  // data, then its flag
    write(kOther + 1, i);
    const std::uint32_t flag = load(kOther + 1);
    changes += flag != 0 && flag != i ? 1 : 0;
    ASSERT_GE(load(kOther), flag);
    if (i % 50 == 0) usleep(100);
  }
  EXPECT_TRUE(comes(kOther + 1, i));
  EXPECT_GT(changes, 0U);
}

TEST_F(ReplicatedCard, SendsTheLongwordOfAByte) {
  auto* const bytes = reinterpret_cast<volatile unsigned char*>(get_base_mem() + kWord);
  store(0x1122'3344);
  ASSERT_TRUE(arrives(0x1122'3344));
  bytes[1] = 0xAB;
  EXPECT_TRUE(arrives(0x1122'AB44));
  *reinterpret_cast<volatile unsigned short*>(bytes + 2) = 0xCDEF;
  EXPECT_TRUE(arrives(0xCDEF'AB44));
}

TEST_F(ReplicatedCard, SendsSixtyFourBitsAsTwoLongwords) {
  *reinterpret_cast<volatile std::uint64_t*>(get_base_mem() + kWord) = 0x1122'3344'5566'7788;
  EXPECT_TRUE(arrives(0x5566'7788));
  EXPECT_TRUE(arrives(0x1122'3344, kWord + 1));
}

TEST_F(ReplicatedCard, GetsOnlyTheLaterWritesWhenItJoinsLate) {
  write(kOther, 1);
  ASSERT_TRUE(comes(kOther, 1));
  set_csr(SCR_CSR0, 0);
  write(kOther, 2);
  write(kOther + 1, 2);
  ASSERT_TRUE(soon([] { return watcher->read(LongwordOffset{kOther + 1}) == 2; }));
  set_csr(SCR_CSR0, 0x8003);
  write(kOther + 2, 3);
  ASSERT_TRUE(comes(kOther + 2, 3));
  EXPECT_EQ(load(kOther), 1U);
}

TEST_F(ReplicatedCard, KeepsStoresInItsTransmitFifoWhileItOnlyReceives) {
  set_csr(SCR_CSR0, 0x8001);
  store(1);
  settle();
  EXPECT_EQ(seen(), 0U);
  EXPECT_TRUE(shows(CSR1_TXFNE));
  write(kOther, 77);
  EXPECT_TRUE(comes(kOther, 77));

  set_csr(SCR_CSR0, 0x8003);
  EXPECT_TRUE(arrives(1));
  settle();
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_TXFNE, 0);
}

TEST_F(ReplicatedCard, ForgetsTheStoresInATransmitFifoThatIsReset) {
  set_csr(SCR_CSR0, 0x8001);
  store(1);
  set_csr(SCR_CSR0, 0xC001);
  EXPECT_EQ(csr(SCR_CSR0), 0xC001);
  set_csr(SCR_CSR0, 0x8001);
  settle();
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_TXFNE, 0);

  set_csr(SCR_CSR0, 0x8003);
  store(2);
  EXPECT_TRUE(arrives(2));
}

TEST_F(ReplicatedCard, IsIsolatedWithoutReceiveAndTransmit) {
  write(kOther, 1);
  ASSERT_TRUE(comes(kOther, 1));
  set_csr(SCR_CSR0, 0x8000);
  store(3);
  write(kOther, 2);
  ASSERT_TRUE(soon([] { return watcher->read(LongwordOffset{kOther}) == 2; }));
  settle();

  EXPECT_EQ(load(kOther), 1U);
  EXPECT_EQ(load(kWord), 3U);
  EXPECT_EQ(seen(), 0U);
}

TEST_F(ReplicatedCard, TransmitsOnlyAndStillPassesMessagesOn) {
  write(kOther, 1);
  ASSERT_TRUE(comes(kOther, 1));
  set_csr(SCR_CSR0, 0x8002);
  store(5);
  write(kOther, 2);
  EXPECT_TRUE(arrives(5));
  EXPECT_TRUE(soon([] { return watcher->read(LongwordOffset{kOther}) == 2; }));
  settle();
  EXPECT_EQ(load(kOther), 1U);
}

TEST_F(ReplicatedCard, SendsNothingWithATimeOutOfZero) {
  set_csr(SCR_CSR5, 0);
  store(4);
  settle();
  EXPECT_EQ(seen(), 0U);

  set_csr(SCR_CSR5, 100);
  EXPECT_EQ(csr(SCR_CSR5), 0);
  EXPECT_TRUE(arrives(4));
}

TEST_F(ReplicatedCard, CountsTheNodesOfItsRingAndIsHealthy) {
  settle();
  EXPECT_EQ(csr(SCR_CSR3), 0x0203);
  EXPECT_EQ(csr(SCR_CSR1) & kHealthy, 0);
}

TEST_F(ReplicatedCard, ShowsReceiveIdAndAgeThroughTheMultiplexer) {
  EXPECT_EQ(sp_txrx_id(0x2A), 2);
  EXPECT_EQ(csr(SCR_CSR3) >> 8, 0x2A);
  add_to_csr(SCR_CSR8, CSR8_IDMX);
  EXPECT_EQ(csr(SCR_CSR3), 0x2A00);
  set_csr(SCR_CSR3, 0x2A07);
  EXPECT_EQ(csr(SCR_CSR3), 0x2A07);
  set_csr(SCR_CSR8, csr(SCR_CSR8) & ~CSR8_IDMX);
  EXPECT_EQ(csr(SCR_CSR3) >> 8, 0x2A);
  store(6);
  EXPECT_TRUE(arrives(6));
  add_to_csr(SCR_CSR8, CSR8_IDMX);
  set_csr(SCR_CSR3, 0x0200);
}

TEST_F(ReplicatedCard, ShowsTheLossOfItsCarrierWhileItLasts) {
  replicated::Action fault;
  fault.kind = replicated::Action::Kind::CutFibre;
  fault.node = kControllerAt;
  replicated::request_fault(name(), fault);
  EXPECT_TRUE(shows(CSR1_CD));
  settle();
  EXPECT_NE(csr(SCR_CSR1) & CSR1_CD, 0);
  fault.kind = replicated::Action::Kind::RepairFibre;
  replicated::request_fault(name(), fault);
  settle();
  static_cast<void>(csr(SCR_CSR1));
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_CD, 0);
}

TEST_F(ReplicatedCard, DeliversTheMessagesOfAnotherNodeWithItsIdAndCountsThem) {
  const std::uint32_t before = card_of("machine").carried->same_id;
  set_csr(SCR_CSR3, 0x0100);  // the controller's
  store(5);
  write(kOther, 6);
  EXPECT_TRUE(arrives(5));
  EXPECT_TRUE(comes(kOther, 6));
  EXPECT_TRUE(soon([=] { return card_of("machine").carried->same_id > before; }));
}

// 92 bits a message at 150 Mbit/s: no write arrives earlier than those before it have been sent.
TEST_F(ReplicatedCard, GetsNoWriteEarlierThanTheRingCanCarryIt) {
  constexpr std::uint32_t kWrites = 3000;
  const auto begin = steady_clock::now();
  for (std::uint32_t i = 1; i <= kWrites; ++i) write(kOther, i);
  while (load(kOther) != kWrites && steady_clock::now() - begin < std::chrono::seconds{2}) {
  }
  const auto took = std::chrono::duration<double>(steady_clock::now() - begin).count();
  EXPECT_EQ(load(kOther), kWrites);
  EXPECT_GE(took, (kWrites - 1) * 92 / 150e6);
}

TEST_F(ReplicatedCard, ClearsOnlyItsOwnMemoryWhileInactive) {
  store(77);
  ASSERT_TRUE(arrives(77));
  set_csr(SCR_CSR0, 0);
  scr_mclr_mm(MEM);
  EXPECT_EQ(load(kWord), 0U);
  settle();
  set_csr(SCR_CSR0, 0x8003);
  settle();
  EXPECT_EQ(seen(), 77U);
}

TEST_F(ReplicatedCard, LoopsItsMessagesBackAfterAReset) {
  scr_acr_write(kWord, ACR_TIE);
  scr_reset_mm();
  EXPECT_EQ(csr(SCR_CSR0), 0);
  EXPECT_EQ(csr(SCR_CSR2), 0);
  EXPECT_EQ(scr_acr_read(kWord), 0);
  set_csr(SCR_CSR0, 0x8003);
  store(6);
  settle();
  usleep(5000);
  EXPECT_EQ(seen(), 0U);
}

}  // namespace
}  // namespace rths::test
