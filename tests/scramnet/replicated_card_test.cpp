// SPDX-License-Identifier: Apache-2.0
//
// The vendor's calls of this process on a replicated ring: its own image and card, and a node of
// our library on another image.
#include <memory>
#include <optional>

#include <unistd.h>

#include <gtest/gtest.h>

#include "support/carried_images.hpp"
#include "support/ring_maps.hpp"
#include "vendor_ring.hpp"

#include <scrplus.h>

namespace {

using rths::LongwordOffset;

constexpr std::uint32_t kWord = 500;  // of the machine in the small map
constexpr int kHealthy = 0x1FFF & ~CSR1_TXFNE;

/// This process is the machine; the controller uses our library.
class ReplicatedCard : public testing::Test {
 protected:
  static std::string name() { return rths::test::unique_ring("replicated_card"); }
  static void SetUpTestSuite() {
    setenv("RTHS_SCRAMNET_RING", name().c_str(), 1);
    setenv("RTHS_SCRAMNET_NODE", "machine", 1);
    images = std::make_unique<rths::test::CarriedImages>(name(), rths::test::small_map());
    ring.emplace(rths::broker::Ring::attach(rths::replicated::image_name(name(), "controller")));
    controller.emplace(ring->join("controller", 0));
    ASSERT_EQ(sp_scram_init(0), 0);
  }
  static void TearDownTestSuite() {
    controller.reset();
    ring.reset();
    images.reset();
  }
  void SetUp() override {
    scr_csr_write(SCR_CSR2, 0xC040);
    scr_csr_write(SCR_CSR0, 0x8003);
    static_cast<void>(scr_csr_read(SCR_CSR1));
    store(0);
    ASSERT_TRUE(arrives(0));
  }
  static void store(unsigned value) { get_base_mem()[kWord] = value; }
  static std::uint32_t seen() { return controller->read(LongwordOffset{kWord}); }
  static bool arrives(std::uint32_t value) {
    for (int i = 0; i < 2000 && seen() != value; ++i) usleep(1000);
    return seen() == value;
  }
  /// CSR1 has the state of the latest scan.
  static bool shows(int bit) {
    for (int i = 0; i < 2000 && (scr_csr_read(SCR_CSR1) & bit) == 0; ++i) usleep(1000);
    return (scr_csr_read(SCR_CSR1) & bit) != 0;
  }
  /// All stores so far have been scanned.
  static void settle() { scr_csr_write(SCR_CSR1, 0); }

  static std::unique_ptr<rths::test::CarriedImages> images;
  static std::optional<rths::broker::Ring> ring;
  static std::optional<rths::broker::Node> controller;
};
std::unique_ptr<rths::test::CarriedImages> ReplicatedCard::images;
std::optional<rths::broker::Ring> ReplicatedCard::ring;
std::optional<rths::broker::Node> ReplicatedCard::controller;

TEST_F(ReplicatedCard, SendsAStoreThroughAPointer) {
  store(7);
  EXPECT_TRUE(arrives(7));
}

TEST_F(ReplicatedCard, ReceivesTheWritesOfOtherNodes) {
  const LongwordOffset word = rths::test::kControllerWord;
  ASSERT_EQ(controller->write(word, 1234), rths::Status::Ok);
  for (int i = 0; i < 2000 && get_base_mem()[word.value()] != 1234; ++i) usleep(1000);
  EXPECT_EQ(get_base_mem()[word.value()], 1234U);
}

TEST_F(ReplicatedCard, KeepsStoresInItsTransmitFifoWhileItOnlyReceives) {
  scr_csr_write(SCR_CSR0, 0x8001);
  store(1);
  settle();
  settle();
  EXPECT_EQ(seen(), 0U);
  EXPECT_TRUE(shows(CSR1_TXFNE));

  scr_csr_write(SCR_CSR0, 0x8003);
  EXPECT_TRUE(arrives(1));
}

TEST_F(ReplicatedCard, ForgetsTheStoresInATransmitFifoThatIsReset) {
  scr_csr_write(SCR_CSR0, 0x8001);
  store(1);
  scr_csr_write(SCR_CSR0, 0xC001);
  scr_csr_write(SCR_CSR0, 0x8001);
  settle();
  EXPECT_EQ(scr_csr_read(SCR_CSR1) & CSR1_TXFNE, 0);

  scr_csr_write(SCR_CSR0, 0x8003);
  store(2);
  EXPECT_TRUE(arrives(2));
}

TEST_F(ReplicatedCard, IsIsolatedWithoutReceiveAndTransmit) {
  const LongwordOffset word = rths::test::kControllerWord;
  ASSERT_EQ(controller->write(word, 1), rths::Status::Ok);
  for (int i = 0; i < 2000 && get_base_mem()[word.value()] != 1; ++i) usleep(1000);
  scr_csr_write(SCR_CSR0, 0x8000);
  store(3);
  ASSERT_EQ(controller->write(word, 2), rths::Status::Ok);
  settle();
  usleep(5000);

  EXPECT_EQ(get_base_mem()[word.value()], 1U);
  EXPECT_EQ(get_base_mem()[kWord], 3U);
  EXPECT_EQ(seen(), 0U);
}

TEST_F(ReplicatedCard, SendsNothingWithATimeOutOfZero) {
  scr_csr_write(SCR_CSR5, 0);
  store(4);
  settle();
  EXPECT_EQ(seen(), 0U);

  scr_csr_write(SCR_CSR5, 100);
  EXPECT_TRUE(arrives(4));
}

TEST_F(ReplicatedCard, CountsTheNodesOfItsRingAndIsHealthy) {
  store(5);
  ASSERT_TRUE(arrives(5));
  settle();
  EXPECT_EQ(scr_csr_read(SCR_CSR3), 0x0102);
  EXPECT_EQ(scr_csr_read(SCR_CSR1) & kHealthy, 0);
}

TEST_F(ReplicatedCard, LoopsItsMessagesBackAfterAReset) {
  scr_reset_mm();
  scr_csr_write(SCR_CSR0, 0x8003);
  store(6);
  settle();
  usleep(5000);
  EXPECT_EQ(seen(), 0U);
}

TEST_F(ReplicatedCard, ShowsItsAcrInItsWindow) {
  store(8);
  ASSERT_TRUE(arrives(8));
  scr_acr_write(kWord, ACR_TIE);
  scr_acr_mm(MAP);
  EXPECT_EQ(get_base_mem()[kWord], static_cast<unsigned>(ACR_TIE));
  scr_acr_mm(UNMAP);
  EXPECT_EQ(get_base_mem()[kWord], 8U);
  scr_acr_write(kWord, 0);
}

}  // namespace
