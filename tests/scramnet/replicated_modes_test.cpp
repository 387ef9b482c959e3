// SPDX-License-Identifier: Apache-2.0
//
// The vendor's calls of this process on a replicated ring: ACR, filter, paging, counter, and cards
// that processes share.
#include <array>
#include <chrono>
#include <string>

#include "replicated_card.hpp"

namespace rths::test {
namespace {

using std::chrono::steady_clock;

TEST_F(ReplicatedCard, OutlivesItsProcesses) {
  EXPECT_EQ(as_node("machine", {"csr9=0055", "acr5=3", "word5=abcd"}), "");
  EXPECT_EQ(as_node("machine", {"csr9", "csr0", "acr5", "word5"}), "5d\n8003\n3\nabcd\n");
  EXPECT_EQ(csr(SCR_CSR9), 0x5D);
  EXPECT_TRUE(arrives(0xABCD, 5));
}

TEST_F(ReplicatedCard, IsSharedByTheProcessesOfItsNode) {
  take_all_interrupts();
  store(0x11);
  EXPECT_EQ(as_node("machine", {"word8", "word9=22", "csr0"}), "11\n806b\n");
  EXPECT_EQ(load(9), 0x22U);
  EXPECT_TRUE(arrives(0x22, 9));
  settle();
  EXPECT_EQ(interrupt(), -1);
}

TEST_F(ReplicatedCard, ShowsItsAcrInItsWindow) {
  store(8);
  ASSERT_TRUE(arrives(8));
  scr_acr_write(kWord, ACR_TIE);
  scr_acr_mm(MAP);
  EXPECT_EQ(load(kWord), static_cast<unsigned>(ACR_TIE));
  store(0xFFFF'FFE5);
  write(kOther, 5);
  settle();
  scr_acr_mm(UNMAP);
  EXPECT_EQ(load(kWord), 8U);
  EXPECT_EQ(load(kOther), 5U);
  EXPECT_EQ(scr_acr_read(kWord), 5);
}

TEST_F(ReplicatedCard, KeepsItsMemoryWhenItsAcrIsCleared) {
  store(8);
  for (std::uint32_t word = 0; word < kPage; word += 7)
    scr_acr_write(word, static_cast<unsigned char>(ACR_RIE | ACR_TIE));
  scr_mclr_mm(ACR);
  for (std::uint32_t word = 0; word < kPage; word += 7) ASSERT_EQ(scr_acr_read(word), 0);
  EXPECT_EQ(load(kWord), 8U);
  EXPECT_EQ(csr(SCR_CSR0), 0x8003);
  EXPECT_EQ(csr(SCR_CSR2), 0xC040);
}

// Messages that came since the counter of network events was cleared.
std::uint32_t messages() { return scr_csr_read(SCR_CSR13); }

TEST_F(ReplicatedCard, GetsNoUnchangedWritesOfANodeWithADataFilter) {
  sp_set_cntr(CNTR_NET_EVENTS);
  write(kOther, 9);
  ASSERT_TRUE(comes(kOther, 9));
  const auto write_twice_and_change = [] {
    set_csr(SCR_CSR13, 0);
    write(kOther, load(kOther));
    write(kOther, load(kOther));
    write(kOther, load(kOther) + 1);
    write(kOther + 1, load(kOther + 1) + 1);
    ASSERT_TRUE(comes(kOther + 1, seen(kOther + 1)));
    settle();
  };
  write_twice_and_change();
  EXPECT_EQ(messages(), 4U);
  as_node("controller", {"csr0=8c03"});
  write_twice_and_change();
  EXPECT_EQ(messages(), 2U);
  as_node("controller", {"csr0=8403"});  // not in the lowest 4 KiB
  write_twice_and_change();
  EXPECT_EQ(messages(), 4U);
  as_node("controller", {"csr0=8003"});
}

TEST_F(ReplicatedCard, MapsItsWindowToAPageOfTheRing) {
  store(3);
  ASSERT_TRUE(arrives(3));
  ASSERT_EQ(sp_set_vp(VP_SET, 1), 1);
  write(kOtherOnPage, 7);
  EXPECT_TRUE(comes(kOtherOnPage - kPage, 7));
  store(55);
  EXPECT_TRUE(arrives(55, kPage + kWord));
  EXPECT_EQ(seen(), 3U);
  EXPECT_EQ(sp_set_vp(VP_READ, 0), 1);
  EXPECT_EQ(sp_set_vp(VP_SET, 4), -1);  // beyond the ring
  EXPECT_EQ(sp_set_vp(VP_RESET, 0), 0);
  EXPECT_EQ(load(kWord), 3U);
}

// A card stores the words of a message that are in its window.
TEST_F(ReplicatedCard, ShowsThePartOfATearGroupThatItsPageHas) {
  const TearGroupId group = controllers_ring->tear_group("controller" + std::to_string(kGroup));
  const std::array<std::uint32_t, kGroupLongwords> first{1, 2, 3, 4, 5, 6, 7, 8},
      second{11, 12, 13, 14, 15, 16, 17, 18};
  ASSERT_EQ(sp_set_vp(VP_SET, 1), 1);
  ASSERT_EQ(controller->write_group(group, first), Status::Ok);
  EXPECT_TRUE(comes(3, 8));
  EXPECT_EQ(load(0), 5U);
  ASSERT_EQ(sp_set_vp(VP_RESET, 0), 0);
  ASSERT_EQ(controller->write_group(group, second), Status::Ok);
  EXPECT_TRUE(comes(kGroup + 3, 14));
  EXPECT_EQ(load(kGroup), 11U);
}

TEST_F(ReplicatedCard, CountsTheMessagesThatCome) {
  sp_set_cntr(CNTR_NET_EVENTS);
  for (std::uint32_t i = 0; i < 7; ++i) write(kOther, i);
  EXPECT_TRUE(soon([] { return messages() == 7; }));
  set_csr(SCR_CSR13, 0xFFFE);
  static_cast<void>(csr(SCR_CSR1));
  write(kOther, 1);
  EXPECT_TRUE(soon([] { return messages() == 0xFFFF; }));
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_GPCO, 0);
  write(kOther, 2);
  EXPECT_TRUE(soon([] { return messages() == 0; }));
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_GPCO, CSR1_GPCO);
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_GPCO, 0);  // read once
}

TEST_F(ReplicatedCard, CountsTriggersOfItsWords) {
  sp_set_cntr(CNTR_TRIGS);
  scr_acr_write(kOther, ACR_TRIG2);
  for (std::uint32_t i = 0; i < 5; ++i) write(kOther, i);
  EXPECT_TRUE(soon([] { return messages() == 5; }));
}

// 82 bits, two nodes of 37 bits and four fibres of 10 m at 5 ns/m.
TEST_F(ReplicatedCard, MeasuresTheTimeAroundItsRing) {
  sp_set_cntr(CNTR_TRANSIT);
  store(5);
  ASSERT_TRUE(arrives(5));
  settle();
  EXPECT_NEAR(csr(SCR_CSR13) * 26.667, (82 + 2 * 37) * 1e3 / 150 + 4 * 50, 27);
}

TEST_F(ReplicatedCard, RunsItsCounterWithTheHostsClock) {
  constexpr double kTick = 1.706e-6, kWrap = 0x10000 * kTick;
  sp_set_cntr(CNTR_FREERUN_T2);
  for (int attempt = 0; attempt < 20; ++attempt) {
    const auto outer = steady_clock::now();
    const int first = csr(SCR_CSR13);
    const auto inner = steady_clock::now();
    usleep(3000);
    const std::chrono::duration<double> shortest = steady_clock::now() - inner;
    const int second = csr(SCR_CSR13);
    const std::chrono::duration<double> longest = steady_clock::now() - outer;
    if (longest.count() > kWrap / 2) continue;  // the host was busy
    const double counted = ((second - first) & 0xFFFF) * kTick;
    EXPECT_GE(counted, shortest.count() - 2 * kTick);
    EXPECT_LE(counted, longest.count() + 2 * kTick);
    return;
  }
  GTEST_SKIP() << "SKIPPED: the host is too busy";
}

}  // namespace
}  // namespace rths::test
