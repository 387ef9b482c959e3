// SPDX-License-Identifier: Apache-2.0
//
// The vendor's self-tests of a board, in virtual time.
#include <random>
#include <set>

#include "virtual_cards.hpp"

namespace rths::test {
namespace {

class SelfTests : public VirtualCards {
 protected:
  static constexpr std::uint32_t kWireLoopback = 0xC0C0;
  void use_looped(std::uint32_t csr0, std::uint32_t csr2) {
    use(nodes(1));
    csr(0, 2, csr2);
    csr(0, 0, csr0);
  }
};

TEST_F(SelfTests, OfTheTransmitFifoPass) {
  use_looped(1, kWireLoopback | 0x100);
  for (std::uint32_t stores = 1; stores <= 1022; ++stores) {
    store(0, stores, stores);
    const std::uint32_t status = csr(0, 1);
    ASSERT_EQ(status & 2, 2U);
    ASSERT_EQ((status & 4) != 0, stores >= 896) << stores;
    ASSERT_EQ((status & 1) != 0, stores >= 1022) << stores;
    ASSERT_EQ(load(0, stores), 0U);
  }
  EXPECT_EQ(csr(0, 1) & 7, 7U);  // still
  csr(0, 2, kWireLoopback | 0x300);
  csr(0, 0, 3);
  settle();
  for (std::uint32_t i = 1; i <= 1022; ++i) ASSERT_EQ(load(0, i), i);
}

TEST_F(SelfTests, OfTheInterruptFifoPass) {
  use_looped(0x012B, kWireLoopback | 0x700);
  std::mt19937 random{7};
  std::set<std::uint32_t> chosen;
  while (chosen.size() < 1024) chosen.insert(random() % 0x8'0000);
  std::vector<std::uint32_t> words(chosen.begin(), chosen.end());
  std::shuffle(words.begin(), words.end(), random);
  for (const std::uint32_t word : words) acr(0, word, 3);
  for (std::uint32_t i = 0; i < 1024; ++i) {
    store(0, words[i], i + 5);
    settle();
    ASSERT_EQ((csr(0, 1) & 0x10) != 0, i == 1023) << i;
  }
  for (std::uint32_t i = 0; i < 1024; ++i) {
    ASSERT_EQ(interrupt(0), 4 * std::int64_t{words[i]});
    ASSERT_EQ(load(0, words[i]), i + 5);
  }
  EXPECT_EQ(interrupt(0), -1);
}

TEST_F(SelfTests, OfRandomInterruptCountsPass) {
  for (const std::uint32_t stores : {1U, 17U, 512U, 1023U}) {
    use_looped(0x036B, kWireLoopback | 0x700);
    for (std::uint32_t i = 0; i < stores; ++i) store(0, i, 1);
    settle();
    EXPECT_EQ(interrupts(0), stores);
  }
}

// The four-way table: which messages return, by ids and by CSR2.8 and 2.9.
TEST_F(SelfTests, OfReceiveAndTransmitIdsPass) {
  for (const std::uint32_t host_off : {0U, 0x100U})
    for (const std::uint32_t own : {0U, 0x200U})
      for (const bool same : {true, false}) {
        use_looped(3, kWireLoopback | host_off | own);
        csr(0, 9, 0x6000);
        csr(0, 8, csr(0, 8) | 1);
        csr(0, 3, (same ? 1U : 2U) << 8);
        store(0, 5, 9);
        settle();
        const std::uint32_t expected = !same ? 256 : own != 0 ? 1 : 0;
        EXPECT_EQ(csr(0, 13), expected) << host_off << own << same;
        EXPECT_EQ(load(0, 5), same && host_off != 0 && own == 0 ? 0U : 9U);
      }
}

TEST_F(SelfTests, OfAForeignIdInPlatinumShowARetryAfterATimeOut) {
  use_looped(3, 0x40C0);
  csr(0, 8, csr(0, 8) | 1);
  csr(0, 3, 2U << 8);
  store(0, 5, 9);
  pass(200us);
  EXPECT_EQ(csr(0, 1) & 0x400, 0x400U);
  EXPECT_GT(card(0).report().repeated, 0U);
}

TEST_F(SelfTests, OfTheCounterPass) {
  use_looped(3, kWireLoopback | 0x300);
  csr(0, 9, 0x6000);
  for (std::uint32_t i = 0; i < 255; ++i) store(0, i, 1);
  settle();
  EXPECT_EQ(csr(0, 13), 255U);
  csr(0, 9, 0x2000);
  csr(0, 13, 0);
  acr(0, 1, 0xC);
  for (std::uint32_t i = 0; i < 10; ++i) store(0, 1, i);
  settle();
  EXPECT_EQ(csr(0, 13), 20U);  // both triggers
}

TEST_F(SelfTests, OfRingTimePass) {
  use_inserted(1);
  csr(0, 9, 0x4000);
  csr(0, 13, 0);
  store(0, 1, 1);
  settle();
  EXPECT_NEAR(csr(0, 13) * 26.66, kMessageNs + 50, 27);
  store(0, 1, 1);  // measures once per write of CSR13
  const std::uint32_t measured = csr(0, 13);
  settle();
  EXPECT_EQ(csr(0, 13), measured);
}

TEST_F(SelfTests, OfVirtualPagesPass) {
  RingSetup setup = nodes(2);
  setup.nodes[0].memory_bytes = 4096;
  setup.nodes[1].memory_bytes = 8U << 20;
  use_inserted(setup);
  for (std::uint32_t page = 0; page < 2048; page += 97) {
    csr(0, 12, page == 0 ? 0 : page << 5 | 1);
    store(0, 7, page + 1);
    settle();
    EXPECT_EQ(load(1, page * 1024 + 7), page + 1);
  }
}

TEST_F(SelfTests, OfMemoryByAddressAndWalkingBitsPass) {
  use_inserted(2);
  for (std::uint32_t bit = 0; bit < 32; ++bit) store(0, bit, 1U << bit);
  for (std::uint32_t byte = 0; byte < 16; ++byte) store_bytes(0, 0x400 + byte, byte * 17, 1);
  for (std::uint32_t half = 0; half < 8; ++half) store_bytes(0, 0x500 + 2 * half, half * 0x1111, 2);
  settle();
  for (std::uint32_t node = 0; node < 2; ++node) {
    for (std::uint32_t bit = 0; bit < 32; ++bit) EXPECT_EQ(load(node, bit), 1U << bit);
    for (std::uint32_t byte = 0; byte < 16; ++byte)
      EXPECT_EQ(card(node).read(ByteOffset{0x400 + byte}, 1), byte * 17);
    for (std::uint32_t half = 0; half < 8; ++half)
      EXPECT_EQ(card(node).read(ByteOffset{0x500 + 2 * half}, 2), half * 0x1111);
  }
}

TEST_F(SelfTests, OfTheAcrKeepFiveBits) {
  use_inserted(1);
  csr(0, 0, kOnRing | 0x10);
  for (std::uint32_t word = 0; word < 100; ++word) store(0, word, 0xFFFF'FF00 | word);
  for (std::uint32_t word = 0; word < 100; ++word) EXPECT_EQ(load(0, word), word & 0x1F);
}

}  // namespace
}  // namespace rths::test
