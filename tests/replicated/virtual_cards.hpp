// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include <rths/replicated/ring.hpp>

namespace rths::test {

using namespace std::chrono_literals;
using replicated::Access;
using replicated::CardType;
using replicated::Hop;
using replicated::RingSetup;
using replicated::Time;
using replicated::to_ns;

// Durations of the manual, as closed forms for the tests [ns].
constexpr double kBitNs = 1e3 / 150;
constexpr double kMessageNs = 82 * kBitNs;
constexpr double kNodeNs = 37 * kBitNs;
constexpr double kMetreNs = 5;
constexpr double kTickNs = 1.0 / 15;

constexpr std::uint32_t kBurst = 0xC040, kBurst256 = 0xD040, kBurst1024 = 0xD840,
                        kPlatinum = 0x4040;
constexpr std::uint32_t kOnRing = 0x8003;

/// A setup of nodes with ids 1, 2, … and 10 m of fibre behind each.
inline RingSetup nodes(std::uint32_t count, CardType cards = CardType::Plus) {
  RingSetup setup;
  setup.cards = cards;
  for (std::uint32_t i = 0; i < count; ++i) setup.nodes.push_back({.id = (i + 1) % 256});
  return setup;
}

/// A ring in virtual time for one test. Nodes are named by position.
class VirtualCards : public testing::Test {
 protected:
  using Nodes = std::initializer_list<std::uint32_t>;

  void use(const RingSetup& setup) {
    ring_.emplace(setup);
    hops_.clear();
    ring_->observe([this](const Hop& hop) { hops_.push_back(hop); });
  }
  /// Cards that are inserted, receive and transmit.
  void use_inserted(std::uint32_t count, std::uint32_t csr2 = kBurst) {
    use_inserted(nodes(count), csr2);
  }
  void use_inserted(const RingSetup& setup, std::uint32_t csr2 = kBurst) {
    use(setup);
    for (std::uint32_t node = 0; node < setup.nodes.size(); ++node) {
      csr(node, 2, csr2);
      csr(node, 0, kOnRing);
    }
  }

  replicated::Ring& ring() { return *ring_; }
  replicated::Card card(std::uint32_t node) { return ring_->card(node); }
  std::uint32_t csr(std::uint32_t node, int index) { return card(node).read_csr(index); }
  void csr(std::uint32_t node, int index, std::uint32_t value) {
    card(node).write_csr(index, value);
  }
  void acr(std::uint32_t node, std::uint32_t longword, std::uint32_t bits) {
    card(node).set_acr(LongwordOffset{longword}, bits);
  }
  Access store(std::uint32_t node, std::uint32_t longword, std::uint32_t value) {
    return card(node).write(ByteOffset{4 * longword}, value);
  }
  Access store_bytes(std::uint32_t node, std::uint32_t offset, std::uint32_t value,
                     std::uint32_t bytes) {
    return card(node).write(ByteOffset{offset}, value, bytes);
  }
  std::uint32_t load(std::uint32_t node, std::uint32_t longword) {
    return card(node).read(ByteOffset{4 * longword});
  }
  /// Lets everything on the ring come to its end.
  void settle() { ASSERT_TRUE(ring_->run_until_idle(ring_->now() + 1s)); }
  void pass(Time time) { ring_->run_until(ring_->now() + time); }

  /// The next address in the interrupt FIFO, through CSR5 and CSR4; −1: none.
  std::int64_t interrupt(std::uint32_t node) {
    const std::uint32_t high = csr(node, 5);
    if ((high & 0x8000) == 0) return -1;
    return std::int64_t{high & 0x7F} << 16 | csr(node, 4);
  }
  std::uint32_t interrupts(std::uint32_t node) {
    std::uint32_t count = 0;
    while (interrupt(node) >= 0) ++count;
    return count;
  }

  /// Hops of a kind at a node so far.
  std::vector<Hop> hops(Hop::Kind kind, std::uint32_t node) const {
    std::vector<Hop> found;
    for (const Hop& hop : hops_)
      if (hop.kind == kind && hop.node == node) found.push_back(hop);
    return found;
  }

 private:
  std::optional<replicated::Ring> ring_;
  std::vector<Hop> hops_;
};

/// Registers and modes of SCRAMNet+ cards.
class Control : public VirtualCards {
 protected:
  /// CSR1 bit 1: whether the transmit FIFO holds anything.
  bool has_queued(std::uint32_t node) { return (csr(node, 1) & 2) != 0; }
};

}  // namespace rths::test
