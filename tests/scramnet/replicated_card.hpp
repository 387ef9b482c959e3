// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <unistd.h>

#include <gtest/gtest.h>

#include <rths/card/shared_cards.hpp>

#include "support/carried_images.hpp"
#include "support/ring_maps.hpp"
#include "vendor_ring.hpp"

#include <scrplus.h>

namespace rths::test {

/// Three nodes on a ring of 8 KiB, in the direction of travel: the controller, the machine, and a
/// watcher. This process is the machine, by the vendor's calls, with a card of 4 KiB. Controller
/// and watcher use our library.
class ReplicatedCard : public testing::Test {
 protected:
  static constexpr std::uint32_t kWord = 8;     // of the machine
  static constexpr std::uint32_t kOther = 128;  // first of the controller's
  static constexpr std::uint32_t kOthers = 128;
  static constexpr std::uint32_t kPage = 1024;  // longwords of the window
  static constexpr std::uint32_t kOtherOnPage = kPage + 128;
  static constexpr std::uint32_t kOwnPage = 3;  // of the machine alone
  static constexpr std::uint32_t kGroupLongwords = 8;
  static constexpr std::uint32_t kGroup = kPage - 4;  // of the controller, on both pages
  static constexpr std::uint32_t kControllerAt = 0;   // position on the ring
  static constexpr int kHealthy = 0x1FFF & ~CSR1_TXFNE;

  static std::string name() { return unique_ring("replicated_card"); }
  static std::string image(const std::string& node) { return replicated::image_name(name(), node); }
  static memmap::Map map();
  static void SetUpTestSuite();
  static void TearDownTestSuite();
  void SetUp() override;
  /// Runs `registers` as a node of this ring, which shares its card. @returns its output
  static std::string as_node(const std::string& node, std::vector<std::string> arguments);

  static void store(std::uint32_t value, std::uint32_t longword = kWord) {
    get_base_mem()[longword] = value;
  }
  static std::uint32_t load(std::uint32_t longword) { return get_base_mem()[longword]; }
  static std::uint32_t seen(std::uint32_t longword = kWord) {
    return controller->read(LongwordOffset{longword});
  }
  static void write(std::uint32_t longword, std::uint32_t value) {
    ASSERT_EQ(controller->write(LongwordOffset{longword}, value), Status::Ok);
  }
  /// Waits up to two seconds. @returns whether the claim has become true
  static bool soon(const std::function<bool()>& claim) {
    for (int i = 0; i < 4000; ++i, usleep(500))
      if (claim()) return true;
    return false;
  }
  /// A store of the machine reaches the controller.
  static bool arrives(std::uint32_t value, std::uint32_t longword = kWord) {
    return soon([=] { return seen(longword) == value; });
  }
  /// A write of the controller reaches the machine.
  static bool comes(std::uint32_t longword, std::uint32_t value) {
    return soon([=] { return load(longword) == value; });
  }
  /// CSR1 has the state of the latest scan.
  static bool shows(int bit) {
    return soon([=] { return (scr_csr_read(SCR_CSR1) & bit) != 0; });
  }
  static int csr(int index) { return scr_csr_read(index); }
  static void set_csr(int index, int value) {
    scr_csr_write(index, static_cast<unsigned short>(value));
  }
  static void add_to_csr(int index, int bits) { set_csr(index, csr(index) | bits); }
  /// All stores so far have been scanned and their messages have been around the ring.
  static void settle() {
    for (int i = 0; i < 3; ++i) set_csr(SCR_CSR10, csr(SCR_CSR10));
  }
  /// The card of a node as others see it.
  static scramnet::SharedCard card_of(const std::string& node) {
    return scramnet::cards_of(image(node)).at(0);
  }

  /// Every word of the machine interrupts when any message of another node comes.
  static void take_all_interrupts() {
    add_to_csr(SCR_CSR8, 0x400);
    set_csr(SCR_CSR0, 0x806B);
    set_csr(SCR_CSR1, 0);
  }
  /// Address in the interrupt FIFO, or -1.
  static std::int64_t interrupt() {
    unsigned address = 0;
    return scr_read_int_fifo(&address) == 1 ? std::int64_t{address} : -1;
  }
  static std::uint32_t queued() { return card_of("machine").interrupt_fifo; }

  static std::unique_ptr<CarriedImages> images;
  static std::optional<broker::Ring> controllers_ring, watchers_ring;
  static std::optional<broker::Node> controller, watcher;
  static std::vector<int> at_start;  ///< CSRs after the first sp_scram_init
};

}  // namespace rths::test
