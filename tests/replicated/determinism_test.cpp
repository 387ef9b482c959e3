// SPDX-License-Identifier: Apache-2.0
#include <random>
#include <string>

#include "support/long_run.hpp"
#include "support/realtime_guard.hpp"
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

class Determinism : public testing::Test {
 protected:
  struct Outcome {
    std::uint64_t hash, hops;
    std::uint32_t memory;  // sum of some words of all nodes
  };

  // Random stores of random nodes at random times, with bit errors.
  static Outcome run(std::uint32_t count, std::uint32_t writes, std::uint64_t seed) {
    RingSetup setup = nodes(count);
    setup.bit_error_rate = 1e-7;
    setup.seed = seed;
    replicated::Ring ring{setup};
    for (std::uint32_t node = 0; node < count; ++node) {
      ring.card(node).write_csr(2, node % 3 == 0 ? kBurst256 : kBurst);
      ring.card(node).write_csr(0, kOnRing);
    }
    std::mt19937_64 random{seed};
    for (std::uint32_t i = 0; i < writes; ++i) {
      ring.run_until(ring.now() + Time{static_cast<Time::rep>(random() % 30'000)});
      ring.card(static_cast<std::uint32_t>(random() % count))
          .write(ByteOffset{static_cast<std::uint32_t>(random() % 4096 * 4)},
                 static_cast<std::uint32_t>(random()));
    }
    EXPECT_TRUE(ring.run_until_idle(ring.now() + 10s));
    std::uint32_t memory = 0;
    for (std::uint32_t node = 0; node < count; ++node)
      for (std::uint32_t word = 0; word < 64; ++word)
        memory = memory * 31 + ring.card(node).read(ByteOffset{word * 64});
    return {ring.log_hash(), ring.hops(), memory};
  }
};

// 20,000 writes on 256 nodes are 5 million hops; with RTHS_LONG=1 a million writes. Sanitizers have
// fewer.
TEST_F(Determinism, GivesTheSameLogForTheSameSeedOn256Nodes) {
  const std::uint32_t writes =
      RealTimeGuard::supported() ? (is_long() ? 1'000'000 : 20'000) : (is_long() ? 3'000 : 1'000);
  const Outcome first = run(256, writes, 5);
  const Outcome second = run(256, writes, 5);
  EXPECT_EQ(first.hash, second.hash);
  EXPECT_EQ(first.memory, second.memory);
  EXPECT_EQ(first.hops, second.hops);
  EXPECT_GT(first.hops, writes * 250.0);
}

TEST_F(Determinism, GivesAnotherLogForAnotherSeed) {
  EXPECT_NE(run(16, 500, 5).hash, run(16, 500, 6).hash);
}

TEST(VirtualRing, AllocatesNothingPerHop) {
  replicated::Ring ring{nodes(16)};
  for (std::uint32_t node = 0; node < 16; ++node) ring.card(node).write_csr(0, kOnRing);
  const auto work = [&] {
    for (std::uint32_t i = 0; i < 500; ++i) ring.card(i % 16).write(ByteOffset{i * 4}, i);
    static_cast<void>(ring.run_until_idle(ring.now() + 1s));
  };
  work();
  const std::uint64_t before = ring.hops();
  EXPECT_REALTIME(work());
  EXPECT_GE(ring.hops(), before + 500 * 16);
}

TEST(VirtualRing, RefusesImpossibleSetups) {
  EXPECT_ANY_THROW(replicated::Ring{nodes(0)});
  EXPECT_ANY_THROW(replicated::Ring{nodes(257)});
  RingSetup setup = nodes(2);
  setup.nodes[1].id = 256;
  EXPECT_ANY_THROW(replicated::Ring{setup});
  setup = nodes(2);
  for (const double fibre_m : {-1.0, 1e6 + 1}) {
    setup.nodes[0].fibre_m = fibre_m;
    EXPECT_ANY_THROW(replicated::Ring{setup});
  }
  setup.nodes[0].fibre_m = 1e6;
  EXPECT_NO_THROW(replicated::Ring{setup});
  setup = nodes(2);
  for (const std::uint64_t bytes : {0U, 2U, 6U, (512U << 20U) + 4U}) {
    setup.nodes[0].memory_bytes = bytes;
    EXPECT_ANY_THROW(replicated::Ring{setup});
  }
  setup.nodes[0].memory_bytes = 512U << 20U;
  EXPECT_NO_THROW(replicated::Ring{setup});
}

}  // namespace
}  // namespace rths::test
